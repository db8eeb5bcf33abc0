// SPDX-License-Identifier: Apache-2.0
// The comparators count what their grids show, right or wrong.
#include "topology/morse/region_growing.h"

#include <gtest/gtest.h>

#include "tests/hypertexture_geom/test_fields.h"
#include "tests/topology/blobs.h"
#include "tests/topology/flood_fill.h"

namespace morsel::topology {
namespace {

using testing::Blobs;

const Box kBox(Imath::V3d(-4.0), Imath::V3d(4.0));

TEST(RegionGrowing, BlobsFarApartAndJoined) {
  const Blobs apart({{-2, 0, 0}, {1, 0.1, 0}, {1, 2.6, 0.3}}, 1.0, 0.3);
  const Blobs joined({{-1, 0, 0}, {0, 0.1, 0}, {1, 0.2, 0}}, 1.0, 0.3);
  for (const int n : {33, 64, 100}) {
    EXPECT_EQ(grow_voxel_regions(apart, kBox, n).components, 3u);
    EXPECT_EQ(grow_mesh_regions(apart, kBox, n).components, 3u);
    EXPECT_EQ(grow_voxel_regions(joined, kBox, n).components, 1u);
    EXPECT_EQ(grow_mesh_regions(joined, kBox, n).components, 1u);
  }
  const Blobs none({{50, 0, 0}}, 1.0, 0.3);
  EXPECT_EQ(grow_voxel_regions(none, kBox, 20).components, 0u);
  EXPECT_EQ(grow_mesh_regions(none, kBox, 20).elements, 0u);
}

TEST(RegionGrowing, AMeshIsClosed) {
  // Euler's formula for a sphere is too much to ask of a count; its area is not: triangles grow
  // with the square of the resolution.
  const Blobs ball({{0.01, 0.02, 0.03}}, 2.0, 0.3);
  const RegionCount a = grow_mesh_regions(ball, kBox, 40), b = grow_mesh_regions(ball, kBox, 80);
  EXPECT_EQ(a.components, 1u);
  EXPECT_NEAR(static_cast<double>(b.elements) / static_cast<double>(a.elements), 4.0, 0.15);
  EXPECT_EQ(a.elements % 2, 0u);  // each edge of a closed surface has two triangles: 3 T = 2 E
}

// Figure 2 of the paper: a gap narrower than a voxel isn't seen.
TEST(RegionGrowing, NarrowGapsAreMissed) {
  const Blobs gap({{-1.05, 0.01, 0.02}, {1.05, 0.01, 0.02}}, 1.5, 0.3);
  EXPECT_EQ(grow_voxel_regions(gap, kBox, 16).components, 1u);
  EXPECT_EQ(grow_voxel_regions(gap, kBox, 128).components, 2u);
}

TEST(RegionGrowing, AgreesWithAFloodFillWhereTheGridIsFine) {
  const auto field = geom::testing::field_of(geom::testing::eq13_json(1, 4, 0.7, 1.5));
  const std::uint64_t fine = grow_mesh_regions(*field, kBox, 160).components;
  EXPECT_EQ(fine, static_cast<std::uint64_t>(testing::flood_fill(*field, kBox, 160)));
}

TEST(RegionGrowing, BadResolutionsAreRefused) {
  const Blobs ball({{0, 0, 0}}, 2.0, 0.3);
  EXPECT_THROW(grow_voxel_regions(ball, kBox, 1), std::invalid_argument);
  EXPECT_THROW(grow_mesh_regions(ball, kBox, 100000), std::invalid_argument);
}

}  // namespace
}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
// The level at which the mesh is made: counted in its error, and no obstacle to its topology.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/hypertexture_geom/test_fields.h"
#include "tests/topology/blobs.h"
#include "tests/topology/mesh/closed_mesh.h"
#include "topology/mesh/mesh.h"

namespace morsel::topology {
namespace {

using geom::testing::field_of;
using testing::Blobs;
using testing::certify_in;
using testing::cube;
using testing::distance_to_surface;
using testing::expect_closed_manifold;
using testing::mesh_of;
using testing::two_blobs;

TEST(MeshLevel, ErrorsLargerThanTheObjectAreBounded) {
  const auto field = field_of({{"density", {{"type", "sphere"}, {"radius", 1.0}}}});
  const Topology t = certify_in(*field, cube(1.3));
  for (const double error : {1.0, 1e6, 1e300}) {
    SCOPED_TRACE(error);
    const Mesh mesh = mesh_of(*field, t, error);
    EXPECT_TRUE(mesh.certified);
    expect_closed_manifold(mesh);
    ASSERT_EQ(mesh_components(mesh).size(), 1u);
    EXPECT_EQ(mesh_components(mesh)[0].euler_characteristic, 2);
    EXPECT_LT(mesh.error_bound, 0.5);
    for (const Imath::V3d& x : mesh.positions)
      ASSERT_LE(distance_to_surface(*field, x, 0.5), mesh.error_bound);
  }
}

TEST(MeshLevel, BridgesAndGapsBelowTheLevel) {
  for (const double error : {0.01, 0.5, 10.0}) {
    for (int digits = 8; digits <= 9; ++digits) {
      for (const bool joined : {false, true}) {
        SCOPED_TRACE(::testing::Message() << error << " " << digits << joined);
        const double size = std::pow(10.0, -digits);
        const Blobs field = two_blobs(joined ? size : -size, {0.3, 0.5, 0.8}, {0.01, 0.02, 0.03});
        const Topology t = certify_in(field, cube(2.4));
        ASSERT_TRUE(t.certified);
        const Mesh mesh = mesh_of(field, t, error);
        EXPECT_TRUE(mesh.certified);
        EXPECT_LE(mesh.error_bound, error);
        EXPECT_EQ(mesh.unresolved_cells, 0u);
        expect_closed_manifold(mesh);
        const std::vector<MeshComponent> parts = mesh_components(mesh);
        ASSERT_EQ(parts.size(), joined ? 1u : 2u);
        for (const MeshComponent& part : parts) {
          EXPECT_EQ(part.surfaces, 1u);
          EXPECT_EQ(part.euler_characteristic, 2);
        }
      }
    }
  }
}

// The residual of a vertex is a bound, also where rounding is all of it.
TEST(MeshLevel, WhatRoundingTakesUpIsRefused) {
  const Blobs near({Imath::V3d(0.0)}, 1.0, 0.3);
  const Topology t = certify_in(near, cube(1.5));
  try {
    mesh_of(near, t, 1e-14);
    FAIL() << "not refused";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("at least"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("1e-14"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
// Certified counts on many random fields against flood fills on grids that are refined until two of
// them agree; moved boxes; widths of gaps and bridges. Takes minutes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/hypertexture_geom/test_fields.h"
#include "tests/topology/blobs.h"
#include "tests/topology/flood_fill.h"
#include "topology/bound_solid.h"
#include "topology/certified.h"
#include "topology/verify.h"

namespace morsel::topology {
namespace {

using testing::flood_fill;

TEST(CertifiedSlow, CountsOfFortyRandomFields) {
  int compared = 0;
  for (int seed = 101; seed <= 140; ++seed) {
    const double amplitude = 0.4 + 0.02 * (seed % 20), frequency = 1.2 + 0.05 * (seed % 7);
    const auto field =
        geom::testing::field_of(geom::testing::eq13_json(1, seed, amplitude, frequency));
    CertifyOptions options;
    options.box = find_solid(*field, *field->solid_bounds());
    const Topology t = certify(*field, options);
    if (t.certified) {
      EXPECT_EQ(t.components_lo, t.components.size());
    }
    int before = flood_fill(*field, t.box, 96);
    for (const int n : {144, 208}) {
      const int count = flood_fill(*field, t.box, n);
      if (count != before) {
        before = count;
        continue;
      }
      // The grid resolves this field.
      ++compared;
      EXPECT_GE(static_cast<std::uint64_t>(count), t.components_lo) << seed;
      if (t.components_hi) {
        EXPECT_LE(static_cast<std::uint64_t>(count), *t.components_hi) << seed;
      }
      break;
    }
  }
  EXPECT_GE(compared, 30);
}

// The same components, with overlapping volumes, wherever the octree's planes lie.
TEST(CertifiedSlow, IndependentOfTheOrigin) {
  const auto field = geom::testing::field_of(geom::testing::eq13_json(2, 3, 0.8, 2.0));
  CertifyOptions options;
  options.box = Box(Imath::V3d(-3.5), Imath::V3d(3.5));
  const Topology one = certify(*field, options);
  ASSERT_TRUE(one.certified);
  for (const double shift : {0.1 * std::numbers::sqrt2, -0.07 * std::numbers::e}) {
    CertifyOptions moved = options;
    moved.box.min += Imath::V3d(shift, 0.5 * shift, -0.3 * shift);
    moved.box.max += Imath::V3d(shift, 0.5 * shift, -0.3 * shift);
    const Topology other = certify(*field, moved);
    ASSERT_TRUE(other.certified);
    ASSERT_EQ(other.components.size(), one.components.size());
    // Each seed that lies in S is in a component of the other octree, and no two in one.
    std::vector<bool> taken(other.components.size(), false);
    for (const Component& c : one.components) {
      if (c.seed_volume == 0.0) continue;
      const OctreeView::Leaf leaf = other.octree().locate(c.seed);
      const OctreeNode& node = other.nodes[leaf.node];
      ASSERT_NE(node.component, kNoComponent);
      EXPECT_FALSE(taken[node.component]);
      taken[node.component] = true;
      const Component& same = other.components[node.component];
      EXPECT_LE(c.volume_lo, same.volume_hi);
      EXPECT_LE(same.volume_lo, c.volume_hi);
    }
  }
}

TEST(CertifiedSlow, TwoLayersProvedAgainInFull) {
  const auto field = geom::testing::field_of(geom::testing::eq13_json(2, 9, 0.8, 2.0));
  CertifyOptions options;
  options.box = Box(Imath::V3d(-3.0), Imath::V3d(3.0));
  const Topology t = certify(*field, options);
  VerifyOptions full;
  full.full = true;
  const VerifyReport report = verify(*field, t, full);
  EXPECT_TRUE(report.passed()) << (report.failures.empty() ? "" : report.failures[0]);
}

}  // namespace
}  // namespace morsel::topology

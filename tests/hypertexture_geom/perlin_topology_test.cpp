// SPDX-License-Identifier: Apache-2.0
// Certified labelling of spheres with Perlin noise against an independent slow count.
#include <gtest/gtest.h>

#include "tests/hypertexture_geom/test_fields.h"
#include "tests/topology/flood_fill.h"
#include "topology/bound_solid.h"
#include "topology/certified.h"

namespace morsel::geom {
namespace {

TEST(PerlinTopology, AgreesWithAFloodFillThatAgreesWithItself) {
  int compared = 0;
  std::size_t pieces = 0;
  for (int seed = 1; seed <= 12 && compared < 5; ++seed) {
    const auto field = testing::field_of(testing::perlin_json(1, seed, 1.0, 1.5));
    topology::CertifyOptions options;
    options.box = topology::find_solid(*field, *field->solid_bounds());
    const topology::Topology t = topology::certify(*field, options);
    EXPECT_TRUE(t.certified) << seed;
    const int coarse = topology::testing::flood_fill(*field, t.box, 80);
    const int fine = topology::testing::flood_fill(*field, t.box, 160);
    if (coarse != fine) continue;  // the grid doesn't resolve this field: no witness
    ++compared;
    pieces += t.components.size();
    EXPECT_EQ(t.components.size(), static_cast<std::size_t>(fine)) << seed;
  }
  EXPECT_EQ(compared, 5);
  EXPECT_GT(pieces, 10u);  // there was something to count
}

}  // namespace
}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
// Certified labelling of fields with warps and masks, where the answer is known.
#include <gtest/gtest.h>

#include "tests/hypertexture_geom/test_fields.h"
#include "topology/bound_solid.h"
#include "topology/certified.h"

namespace morsel::geom {
namespace {

using nlohmann::json;

topology::Topology certified(const Field& field) {
  topology::CertifyOptions options;
  options.box = topology::dyadic_box(topology::find_solid(field, *field.solid_bounds()));
  return topology::certify(field, options);
}

// A displacement whose slope is below 1 is a homeomorphism, so the number of pieces stays.
TEST(ComposedTopology, AWarpKeepsTheNumberOfPieces) {
  json balls = json::array();
  for (const double x : {-1.0, 0.0, 1.0})
    balls.push_back({{"type", "sphere"}, {"radius", 0.4}, {"center", {x, 0.1 * x, 0.3 * x}}});
  const json apart{{"type", "union"}, {"densities", balls}, {"width", 0.02}};
  for (const char* noise : {"sparse_convolution", "perlin"})
    for (const int seed : {1, 2}) {
      const auto field = testing::field_of({{"density", apart},
                                            {"modulations",
                                             {{{"type", "warp"},
                                               {"noise", noise},
                                               {"amplitude", 0.05},
                                               {"frequency", 1.5},
                                               {"seed", seed}}}}});
      const topology::Topology t = certified(*field);
      EXPECT_TRUE(t.certified) << noise << seed;
      EXPECT_FALSE(t.touches_box.has_value()) << noise << seed;
      EXPECT_EQ(t.components.size(), 3u) << noise << seed;
    }
}

// Where the mask is 0, the field is the density.
TEST(ComposedTopology, AMaskedHalfStaysWhole) {
  const json masked{
      {"density", {{"type", "sphere"}}},
      {"modulations",
       {{{"type", "fbm"},
         {"amplitude", 0.8},
         {"frequency", 2},
         {"seed", 4},
         {"mask", {{"type", "height"}, {"axis", "y"}, {"from", 0.0}, {"to", 0.3}}}}}}};
  const auto field = testing::field_of(masked);
  const topology::Topology t = certified(*field);
  EXPECT_TRUE(t.certified);
  EXPECT_GT(t.components.size(), 1u);
  // All pieces but the one that holds the lower half are above the plane.
  int below = 0;
  for (const topology::Component& c : t.components) below += c.bounds.min.y < -0.5;
  EXPECT_EQ(below, 1);
  EXPECT_GE(t.components[0].volume_hi, 2.0 / 3.0 * 3.14159 * 0.97);
}

}  // namespace
}  // namespace morsel::geom

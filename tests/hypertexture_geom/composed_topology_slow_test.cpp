// SPDX-License-Identifier: Apache-2.0
// Certified labelling of fields with warps, masks and folded noises against an independent slow
// count.
#include <gtest/gtest.h>

#include "tests/hypertexture_geom/test_fields.h"
#include "tests/topology/flood_fill.h"
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

TEST(ComposedTopologySlow, AgreesWithAFloodFillThatAgreesWithItself) {
  const json height{{"type", "height"}, {"axis", "x"}, {"from", -0.5}, {"to", 0.5}};
  const json near{{"type", "density"},
                  {"density", {{"type", "sphere"}, {"radius", 0.9}}},
                  {"from", 0.3},
                  {"to", -0.2}};
  const auto noise = [](const char* type, json extra) {
    json m{{"type", type}, {"frequency", 1.5}, {"amplitude", 0.7}};
    m.update(extra);
    return m;
  };
  const std::vector<json> sequences{
      {noise("fbm", {{"mask", height}})},
      {noise("fbm", {{"mask", near}})},
      {noise("fbm", json::object()), noise("warp", {{"amplitude", 0.15}})},
      {noise("turbulence", {{"amplitude", -0.9}, {"mask", height}})},
      {noise("ridged", {{"amplitude", 0.6}, {"offset", 0.3}, {"squared", false}})},
      {noise("fbm", {{"noise", "perlin"}, {"amplitude", 1.2}}),
       {{"type", "gain"}, {"gain", 0.7}},
       noise("warp", {{"amplitude", 0.1}, {"noise", "perlin"}, {"mask", height}})}};
  int compared = 0;
  std::size_t pieces = 0;
  for (const json& sequence : sequences)
    for (int seed = 1; seed <= 2; ++seed) {
      json modulations = sequence;
      for (json& m : modulations)
        if (m["type"] != "gain") m["seed"] = seed;
      const auto field =
          testing::field_of({{"density", {{"type", "sphere"}}}, {"modulations", modulations}});
      const topology::Topology t = certified(*field);
      EXPECT_TRUE(t.certified) << modulations;
      const int coarse = topology::testing::flood_fill(*field, t.box, 80);
      const int fine = topology::testing::flood_fill(*field, t.box, 160);
      if (coarse != fine) continue;  // the grid doesn't resolve this field: no witness
      ++compared;
      pieces += t.components.size();
      EXPECT_EQ(t.components.size(), static_cast<std::size_t>(fine)) << modulations;
    }
  EXPECT_GE(compared, 6);
  EXPECT_GT(pieces, 15u);
}

}  // namespace
}  // namespace morsel::geom

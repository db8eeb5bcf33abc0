// SPDX-License-Identifier: Apache-2.0
// What a scene may say about a field, and what it hears when it says it wrong.
#include <gtest/gtest.h>

#include "tests/hypertexture_geom/test_fields.h"

namespace morsel::geom {
namespace {

using nlohmann::json;
using testing::eq13_json;
using topology::Box;

// The message of the InputError that `json` provokes as a hypertexture geometry.
std::string error_of(const json& value) {
  try {
    hypertexture_from_json(value, params::Place{"scene.json", "/geometries/0"});
  } catch (const params::InputError& e) {
    return e.what();
  }
  return "no error";
}

json rock() { return {{"name", "rock"}, {"type", "hypertexture"}, {"field", eq13_json(1, 1)}}; }

void expect_all(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
}

TEST(FieldJson, ErrorsNameFilePlaceValueAndChoices) {
  json bad = rock();
  bad["field"]["modulations"][0]["amplitud"] = 1;
  expect_all(error_of(bad), {"scene.json", "/geometries/0/field/modulations/0/amplitud",
                             "amplitude", "known keys"});
  bad = rock();
  bad["field"]["modulations"][0]["layers"] = 0;
  expect_all(error_of(bad), {"/field/modulations/0/layers", "0", "between 1 and 16"});
  bad = rock();
  bad["field"]["modulations"][0]["layers"] = 1.5;
  expect_all(error_of(bad), {"/field/modulations/0/layers", "an integer", "1.5"});
  bad = rock();
  bad["field"]["modulations"][0]["noise"] = "sparse";
  expect_all(error_of(bad),
             {"/field/modulations/0/noise", "sparse", "choices", "sparse_convolution"});
  bad = rock();
  bad["field"]["density"]["type"] = "spere";
  expect_all(error_of(bad), {"/field/density/type", "spere", "did you mean \"sphere\""});
  bad = rock();
  bad["field"]["density"]["radius"] = 0;
  expect_all(error_of(bad), {"/field/density/radius", "0 excluded"});
  bad = rock();
  bad["field"]["density"]["radius"] = std::numeric_limits<double>::infinity();
  expect_all(error_of(bad), {"/field/density/radius", "finite"});
  bad = rock();
  bad["field"].erase("density");
  expect_all(error_of(bad), {"/field", "missing key \"density\""});
  bad = rock();
  bad["bounds"] = {{"min", {0, 0, 0}}, {"max", {1, 0, 1}}};
  expect_all(error_of(bad), {"/bounds", "axis y"});
  bad = rock();
  bad["keep"] = "bigest";
  expect_all(error_of(bad), {"/keep", "bigest", "largest:K"});
  bad = rock();
  bad["field"]["density"]["radius"] = 0.001;
  bad["field"]["modulations"] = json::array();
  bad["bounds"] = {{"min", {2, 2, 2}}, {"max", {3, 3, 3}}};
  EXPECT_EQ(error_of(bad), "no error");
}

// Before anything walks the document: a hundred thousand levels overflowed the stack, and ten
// thousand took all memory for the paths that errors name.
TEST(FieldJson, DocumentsOfEndlessDepthAreRefused) {
  for (const int levels : {300, 10'000, 1'000'000}) {
    for (const char* open : {"[", "{\"densities\":"}) {
      std::string text;
      for (int i = 0; i < levels; ++i) text += open;
      try {
        params::parse_text(text, "deep.json");
        ADD_FAILURE() << levels;
      } catch (const params::InputError& e) {
        EXPECT_NE(std::string(e.what()).find(": nested too deeply: at most 256"), std::string::npos)
            << e.what();
      }
    }
  }
}

TEST(FieldJson, CoordinatesHaveARange) {
  const json bounds{{"min", {-1, -1, -1}}, {"max", {1, 1, 1}}};
  json bad = rock();
  bad["bounds"] = bounds;
  bad["field"]["density"]["center"] = {1e300, 0, 0};
  expect_all(error_of(bad), {"scene.json", "/geometries/0/field/density/center/0", "1e+300",
                             "between -1000000 and 1000000"});
  bad = rock();
  bad["bounds"] = {{"min", {-1, -1, -1}}, {"max", {1, 1, 1e200}}};
  expect_all(error_of(bad),
             {"/geometries/0/bounds/max/2", "1e+200", "between -1000000 and 1000000"});
  bad = rock();
  bad["field"]["modulations"][0]["mask"] = {{"type", "height"}, {"to", -1e9}};
  expect_all(error_of(bad),
             {"/modulations/0/mask/to", "-1000000000", "between -1000000 and 1000000"});
}

// Each number is within its range, but not what they multiply up to.
TEST(FieldJson, AFieldThatOverflowsIsAnError) {
  json bad = rock();
  bad["field"]["modulations"] = json(60, {{"type", "scale_offset"}, {"scale", 1e6}});
  expect_all(error_of(bad), {"scene.json", "/geometries/0/field: ", "not finite", "inf", "at ("});
  bad["bounds"] = {{"min", {-1, -1, -1}}, {"max", {1, 1, 1}}};
  expect_all(error_of(bad), {"/geometries/0/field: ", "not finite", "inf", "at ("});
}

TEST(FieldJson, TheFarthestObjectIsBuilt) {
  json far = rock();
  far["field"] = {{"density", {{"type", "sphere"}, {"center", {1e6, -1e6, 1e6}}}}};
  far["field"]["modulations"] = {{{"type", "fbm"}, {"noise", "perlin"}, {"amplitude", 0.05}}};
  const Hypertexture h = hypertexture_from_json(far, params::Place{"t", ""});
  const topology::TopologyCache cache = build_cache(h);
  EXPECT_EQ(cache.topology.components.size(), 1u);
  EXPECT_TRUE(cache.topology.certified);
}

// The finest lattice at the farthest place: as many cells are looked at as anywhere.
TEST(FieldJson, TheFinestNoiseIsEvaluatedAtTheFarthestPlace) {
  for (const char* noise : {"sparse_convolution", "perlin"})
    for (const json& octaves :
         {json{{"frequency", 1e6}}, json{{"frequency", 1e6}, {"layers", 4}, {"lacunarity", 8}},
          json{{"frequency", 1e6}, {"layers", 10}}}) {
      json m{{"type", "fbm"}, {"noise", noise}};
      m.update(octaves);
      json warp = m, rocks = rock();
      warp["type"] = "warp";
      warp["amplitude"] = 1e6;
      rocks["field"] = {{"density", {{"type", "sphere"}}}, {"modulations", {m, warp, m}}};
      rocks["bounds"] = {{"min", {-1e6, -1e6, -1e6}}, {"max", {1e6, 1e6, 1e6}}};
      // Evaluates at the middle and at the corners.
      const auto field = hypertexture_from_json(rocks, params::Place{"t", ""}).field;
      for (const Imath::V3d& x : {Imath::V3d(1e6), Imath::V3d(1000), Imath::V3d(-1e6, 1e5, 7)}) {
        const double value = field->value(x);
        EXPECT_TRUE(std::isfinite(value)) << rocks << x;
        EXPECT_TRUE(std::isfinite(field->jet(x).value));
        const double h = 2e-10;
        const Box box(x - Imath::V3d(h), x + Imath::V3d(h));
        EXPECT_NEAR(field->restricted_to(box)->value(x), value, 1e-6 * std::abs(value));
        EXPECT_TRUE(field->model(box).range().contains(value)) << rocks << x;
        // Beyond what a scene may ask for: finite all the same, or infinite, but at once.
        field->value(x * 1e300);
        field->model(Box(x * 1e20, x * 1e20));
      }
    }
}

// Impulses within reach are found where a cell is a few units in the last place wide: a point, its
// neighbours and a box about them see the same impulses.
TEST(FieldJson, FarCellsAreListedWhole) {
  json m{{"type", "fbm"}, {"frequency", 1e6}, {"layers", 4}, {"lacunarity", 8}, {"hurst", 0}};
  const auto field = field_from_json({{"density", {{"type", "sphere"}}}, {"modulations", {m}}},
                                     params::Place{"t", ""});
  for (const double far : {1.0, 1e3, 3e5, 999999.0}) {
    for (int n = 0; n < 50; ++n) {
      const Imath::V3d x = Imath::V3d(far, -far, far) + Imath::V3d(n * 1.7e-9, n * 2.3e-9, 0);
      const Imath::V3d reach(3.7e-9);
      const double alone = field->value(x);
      const auto local = field->restricted_to(Box(x - reach, x + reach));
      EXPECT_NEAR(local->value(x), alone, 1e-13 * (1.0 + std::abs(alone))) << far << " " << n;
    }
  }
}

TEST(FieldJson, TheFingerprintFollowsTheFieldAndNotItsSpelling) {
  const params::Place place{"t", ""};
  json first = rock();
  first["bounds"] = {{"min", {-3, -3, -3}}, {"max", {3, 3, 3}}};  // deriving them takes time
  const std::string hash = hypertexture_from_json(first, place).hash;
  json same = first;
  same["field"]["modulations"][0]["lacunarity"] = 2;  // the default, spelled out
  same["field"]["density"]["radius"] = 1;             // 1 for 1.0
  same["keep"] = "all";                               // doesn't touch the topology
  EXPECT_EQ(hypertexture_from_json(same, place).hash, hash);
  json other = first;
  other["field"]["modulations"][0]["seed"] = 2;
  EXPECT_NE(hypertexture_from_json(other, place).hash, hash);
  other = first;
  other["max_depth"] = 19;
  EXPECT_NE(hypertexture_from_json(other, place).hash, hash);
}

TEST(FieldJson, DerivedBoxHoldsThePieces) {
  for (const int seed : {1, 2, 3}) {
    json value = rock();
    value["field"] = eq13_json(1, seed, 0.5, 2.0);
    const Hypertexture h = hypertexture_from_json(value, params::Place{"t", ""});
    const topology::TopologyCache cache = build_cache(h);
    EXPECT_FALSE(cache.topology.touches_box.has_value()) << seed;
    EXPECT_TRUE(cache.topology.certified);
  }
}

}  // namespace
}  // namespace morsel::geom

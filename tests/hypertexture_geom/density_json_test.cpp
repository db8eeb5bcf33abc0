// SPDX-License-Identifier: Apache-2.0
// What a scene may say about densities, and what it hears when it says it wrong.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "hypertexture_geom/field/canonical.h"
#include "hypertexture_geom/field/registry.h"
#include "tests/hypertexture_geom/test_fields.h"

namespace morsel::geom {
namespace {

using nlohmann::json;

// The message of the InputError that a density provokes.
std::string error_of(const json& density) {
  try {
    field_from_json({{"density", density}}, params::Place{"scene.json", "/geometries/0/field"});
  } catch (const params::InputError& e) {
    return e.what();
  }
  return "no error";
}

void expect_all(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
}

json canonical(const json& density) {
  return testing::field_of({{"density", density}})->canonical_json()["density"];
}

TEST(DensityJson, EveryDensityHasAWorkingDefault) {
  for (const DensityEntry& entry : densities()) {
    json description{{"type", entry.declaration.name}};
    if (entry.declaration.name == "metaballs") description["balls"] = {json::object()};
    for (const params::Parameter& p : entry.declaration.parameters) {
      EXPECT_FALSE(p.help.empty()) << entry.declaration.name << "." << p.name;
      if (p.kind == "density")
        description[p.name] = {{{"type", "sphere"}}, {{"type", "torus"}, {"center", {1, 0, 0}}}};
    }
    EXPECT_EQ(error_of(description), "no error") << description;
    const json full = canonical(description);
    for (const params::Parameter& p : entry.declaration.parameters)
      EXPECT_TRUE(full.contains(p.name) || p.optional) << full;
    EXPECT_EQ(canonical(full), full);
  }
}

TEST(DensityJson, ErrorsNamePlaceValueAndChoices) {
  const json sphere{{"type", "sphere"}};
  expect_all(error_of({{"type", "cube"}}),
             {"scene.json", "/geometries/0/field/density/type", "cube", "rounded_box", "union"});
  expect_all(error_of({{"type", "ellipsoid"}, {"radii", {1, 0, 1}}}),
             {"/density/radii/1", "0", "0 excluded"});
  expect_all(error_of({{"type", "ellipsoid"}, {"radii", 0.5}, {"smoothing", 0.6}}),
             {"/density/smoothing", "0.6", "below the smallest radius, 0.5"});
  expect_all(error_of({{"type", "rounded_box"}, {"half_size", {1, 0.2, 1}}, {"rounding", 0.3}}),
             {"/density/rounding", "0.3", "smallest half size, 0.2"});
  expect_all(error_of({{"type", "rounded_box"}, {"rounding", 0.02}, {"smoothing", 0.01}}),
             {"/density/smoothing", "half the rounding, 0.01"});
  expect_all(error_of({{"type", "torus"}, {"axis", {0, 0, 0}}}),
             {"/density/axis", "must not be the zero vector"});
  expect_all(error_of({{"type", "capsule"}, {"start", {1, 0, 0}}}),
             {"/density/end", "coincides", "sphere"});
  expect_all(error_of({{"type", "slab"}, {"half_thickness", -1}}),
             {"/density/half_thickness", "-1", "between 0 and"});
  expect_all(error_of({{"type", "metaballs"}}), {"/density", "missing key \"balls\""});
  expect_all(error_of({{"type", "metaballs"}, {"balls", json::array()}}),
             {"/density/balls", "0 items", "between 1 and"});
  expect_all(error_of({{"type", "metaballs"}, {"balls", {json::object(), {{"radus", 1}}}}}),
             {"/density/balls/1/radus", "did you mean \"radius\""});
  expect_all(error_of({{"type", "metaballs"}, {"balls", {json::object()}}, {"level", 0}}),
             {"/density/level", "0 excluded"});
  expect_all(error_of({{"type", "union"}, {"densities", {sphere}}}),
             {"/density/densities", "1 items", "between 2 and"});
  const json nested{
      {"type", "union"},
      {"densities",
       {sphere,
        {{"type", "difference"}, {"densities", {sphere, {{"type", "sphere"}, {"radius", -2}}}}}}}};
  expect_all(error_of(nested), {"/density/densities/1/densities/1/radius", "-2"});
}

TEST(DensityJson, NestedDefaultsAreFilledIn) {
  const json union_of =
      canonical({{"type", "union"},
                 {"densities",
                  {{{"type", "sphere"}, {"radius", 2}},
                   {{"type", "metaballs"}, {"balls", {{{"center", {1, 0, -0.0}}}}}}}}});
  EXPECT_EQ(union_of["width"], 0.1);
  EXPECT_EQ(union_of["densities"][0]["smoothing"], 0.01);
  EXPECT_EQ(union_of["densities"][0]["radius"].dump(), "2.0");
  EXPECT_EQ(union_of["densities"][1]["balls"][0].dump(),
            R"({"center":[1.0,0.0,0.0],"radius":1.0,"weight":1.0})");
  // One number for three equal ones.
  EXPECT_EQ(canonical({{"type", "ellipsoid"}, {"radii", 2}}),
            canonical({{"type", "ellipsoid"}, {"radii", {2, 2.0, 2}}}));
}

TEST(DensityJson, NestingHasALimit) {
  const auto nested = [](int depth) {
    json d{{"type", "sphere"}};
    for (int i = 0; i < depth; ++i)
      d = {{"type", "union"}, {"densities", {d, {{"type", "sphere"}}}}};
    return d;
  };
  // The field itself is the first of those that hold one another.
  EXPECT_EQ(error_of(nested(kMaxNesting - 1)), "no error");
  expect_all(error_of(nested(kMaxNesting)),
             {"/density/densities/0/densities/0", "nested too deeply", "32"});
}

TEST(DensityJson, AnUnboundedSolidNeedsBounds) {
  json geometry{
      {"name", "wall"}, {"type", "hypertexture"}, {"field", {{"density", {{"type", "slab"}}}}}};
  try {
    hypertexture_from_json(geometry, params::Place{"scene.json", "/geometries/0"});
    FAIL() << "no error";
  } catch (const params::InputError& e) {
    expect_all(e.what(), {"/geometries/0", "unbounded", "\"bounds\""});
  }
  geometry["bounds"] = {{"min", {-1, -1, -1}}, {"max", {1, 1, 1}}};
  const topology::TopologyCache cache =
      build_cache(hypertexture_from_json(geometry, params::Place{"scene.json", ""}));
  EXPECT_EQ(cache.topology.components.size(), 1u);
  EXPECT_TRUE(cache.topology.touches_box.has_value());
}

TEST(DensityJson, TheBlobsOfFigure3AreOnePiece) {
  const std::filesystem::path file =
      std::filesystem::path(MORSEL_SOURCE_DIR) / "scenes/figures/figure3.json";
  std::ifstream in(file);
  const json scene = json::parse(in);  // strictly: no comments
  json geometry = scene["geometries"][0];
  const auto pieces = [&] {
    const topology::Topology t =
        build_cache(hypertexture_from_json(geometry, params::Place{"figure3.json", ""})).topology;
    EXPECT_TRUE(t.certified);
    EXPECT_FALSE(t.touches_box.has_value());
    return t.components.size();
  };
  EXPECT_EQ(pieces(), 1u);
  // The saddle between them is at 2 (1 - (0.8 / 1.4)^2)^3 = 0.611.
  geometry["field"]["density"]["level"] = 0.62;
  EXPECT_EQ(pieces(), 2u);
}

TEST(DensityJson, SchemasDescribeNestedObjects) {
  for (const DensityEntry& entry : densities()) {
    const json schema = params::schema_of(entry.declaration);
    if (entry.declaration.name == "metaballs") {
      const json& balls = schema["properties"]["balls"];
      EXPECT_EQ(balls["minItems"], 1);
      EXPECT_TRUE(balls["items"]["properties"].contains("weight"));
      EXPECT_EQ(schema["required"], json({"balls"}));
    }
    if (entry.declaration.name == "union") {
      EXPECT_EQ(schema["properties"]["densities"]["items"]["allOf"][0]["$ref"],
                "#/definitions/density");
    }
    if (entry.declaration.name == "ellipsoid") {
      EXPECT_EQ(schema["properties"]["radii"]["items"]["exclusiveMinimum"], 0.0);
    }
  }
}

}  // namespace
}  // namespace morsel::geom

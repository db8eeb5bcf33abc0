// SPDX-License-Identifier: Apache-2.0
// The reference of scene files and their schema, both from the declarations.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "hypertexture_geom/params/synonyms.h"
#include "renderer/scene/declarations.h"
#include "renderer/scene/scene_json.h"
#include "renderer/scene/scene_reference.h"

namespace morsel::render {
namespace {

using nlohmann::json;

TEST(SceneReference, ThePageIsUpToDate) {
  const std::string path = std::string(MORSEL_SOURCE_DIR) + "/scenes/REFERENCE.md";
  const std::string expected = scene_reference();
  if (std::getenv("MORSEL_UPDATE_REFERENCE") != nullptr) std::ofstream(path) << expected;
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_TRUE(text.str() == expected)
      << path << " is not what the declarations say: run this test with MORSEL_UPDATE_REFERENCE=1";
}

TEST(SceneReference, EveryParameterIsDescribed) {
  const std::string page = scene_reference();
  for (const params::Declaration* d :
       {&scene_declaration(),        &camera_declaration(),
        &render_declaration(),       &instance_declaration(),
        &model_declaration(),        &principled_declaration(),
        &diffuse_declaration(),      &conductor_declaration(),
        &dielectric_declaration(),   &image_texture_declaration(),
        &ramp_texture_declaration(), &checker_texture_declaration(),
        &mesh_declaration(),         &rectangle_declaration(),
        &sphere_declaration(),       &environment_light_declaration(),
        &sky_light_declaration(),    &rectangle_light_declaration(),
        &disk_light_declaration(),   &sphere_light_declaration(),
        &point_light_declaration(),  &distant_light_declaration()}) {
    EXPECT_NE(page.find("# `" + d->name + "`"), std::string::npos) << d->name;
    for (const params::Parameter& p : d->parameters) EXPECT_FALSE(p.help.empty()) << p.name;
  }
}

// What is declared as a geometry of the scene is what the loader takes, and no two choices of a
// kind accept one object.
TEST(SceneSchema, HasEveryTypeOnce) {
  const json schema = scene_schema();
  std::vector<std::string> types;
  for (const json& choice : schema["definitions"]["geometry"]["oneOf"])
    types.push_back(choice["properties"]["type"]["const"]);
  std::vector<std::string> expected = geometry_types();
  std::sort(types.begin(), types.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(types, expected);
  for (const char* kind : {"material", "texture", "geometry", "light", "density", "modulation"}) {
    std::set<std::string> seen;
    for (const json& choice : schema["definitions"][kind]["oneOf"]) {
      EXPECT_TRUE(seen.insert(choice["properties"]["type"]["const"]).second) << kind;
      const json& required = choice["required"];
      EXPECT_NE(std::find(required.begin(), required.end(), "type"), required.end()) << kind;
    }
  }
  EXPECT_EQ(schema["properties"]["lights"]["items"]["allOf"][0]["$ref"], "#/definitions/light");
  EXPECT_EQ(schema["properties"]["camera"]["properties"]["up"]["type"], "array");
}

// What other renderers call a thing is answered with something that there is.
TEST(SceneSynonyms, EachStandsForAKeyOrATypeOfScenes) {
  const std::string schema = scene_schema().dump();
  std::set<std::pair<std::string_view, std::string_view>> seen;
  for (const auto& [theirs, ours] : params::synonyms()) {
    EXPECT_NE(schema.find(nlohmann::json(ours).dump()), std::string::npos) << ours;
    EXPECT_TRUE(std::all_of(theirs.begin(), theirs.end(), [](char c) {
      return c >= 'a' && c <= 'z';
    })) << theirs;
    EXPECT_NE(theirs, ours);
    EXPECT_TRUE(seen.emplace(theirs, ours).second) << theirs;
  }
}

TEST(SceneSynonyms, AreFoundWhereTheyMeanSomething) {
  const auto suggested = [](const char* name, const params::Declaration& declaration) {
    std::vector<std::string> known;
    for (const params::Parameter& p : declaration.parameters) known.push_back(p.name);
    return params::suggested_name(name, known);
  };
  EXPECT_EQ(suggested("fov", camera_declaration()), "vertical_fov");
  EXPECT_EQ(suggested("lookAt", camera_declaration()), "look_at");
  EXPECT_EQ(suggested("look_from", camera_declaration()), "position");
  EXPECT_EQ(suggested("samples-per-pixel", render_declaration()), "spp");
  EXPECT_EQ(suggested("width", render_declaration()), "resolution");
  EXPECT_EQ(suggested("height", render_declaration()), "resolution");
  EXPECT_EQ(suggested("albedo", diffuse_declaration()), "color");
  EXPECT_EQ(suggested("baseColor", principled_declaration()), "color");
  EXPECT_EQ(suggested("alpha", principled_declaration()), "opacity");
  EXPECT_EQ(suggested("alpha", conductor_declaration()), "roughness");
  EXPECT_EQ(suggested("intensity", rectangle_light_declaration()), "radiance");
  EXPECT_EQ(suggested("radiance", point_light_declaration()), "intensity");
  EXPECT_EQ(suggested("emitters", scene_declaration()), "lights");
  // Misspelt words are found as before, and others are not.
  EXPECT_EQ(suggested("resolutoin", render_declaration()), "resolution");
  EXPECT_EQ(suggested("albedo", camera_declaration()), "");
}

}  // namespace
}  // namespace morsel::render

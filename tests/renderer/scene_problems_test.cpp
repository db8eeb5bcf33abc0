// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "scene_loader_fixture.h"

namespace morsel::render {
namespace {

// One wrong thing in an otherwise right scene: what --set writes, and what the message must hold.
struct BadInput {
  const char* name;
  std::string set;
  std::vector<std::string> message;
};
void PrintTo(const BadInput& input, std::ostream* out) { *out << input.name; }

class BadSceneTest : public SceneLoaderTest, public ::testing::WithParamInterface<BadInput> {};

TEST_P(BadSceneTest, NamesFilePlaceAndChoices) {
  std::string what;
  try {
    load({GetParam().set});
  } catch (const params::InputError& e) {
    what = e.what();
  }
  ASSERT_FALSE(what.empty()) << "accepted";
  std::vector<std::string> parts = GetParam().message;
  parts.push_back((folder_ / "scene.json").string());
  for (const std::string& part : parts)
    EXPECT_NE(what.find(part), std::string::npos) << "\"" << part << "\" in " << what;
  // scene check says the same, and nothing else.
  const std::vector<std::string> problems =
      check_scene(small_scene(), parse({GetParam().set}), options());
  ASSERT_EQ(problems.size(), 1u) << (problems.size() > 1 ? problems[1] : "");
  EXPECT_EQ(problems[0], what);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "scene.cache")) << "a cache was built first";
}

INSTANTIATE_TEST_SUITE_P(
    , BadSceneTest,
    ::testing::Values(
        BadInput{"Version", "morsel=2", {": /morsel: ", "2 is out of range"}},
        BadInput{"UnknownSection", "light=[]", {": /light: ", "did you mean \"lights\""}},
        BadInput{"SectionType", "materials={}", {": /materials: ", "must be an array"}},
        BadInput{"UnknownKey",
                 "camera.fov=40",
                 {": /camera/fov: ", "unknown key", "did you mean \"vertical_fov\""}},
        BadInput{"TypeOfAnotherRenderer",
                 "materials.white.type=lambertian",
                 {": /materials/0/type: ", "did you mean \"diffuse\""}},
        BadInput{
            "WrongType", "render.spp=many", {": /render/spp: ", "must be an integer", "\"many\""}},
        BadInput{
            "NotANumber", "camera.position=[nan, 0, 0]", {": /camera/position: ", "[nan, 0, 0]"}},
        BadInput{"ZeroResolution",
                 "render.resolution=[0, 48]",
                 {": /render/resolution/0: ", "out of range"}},
        BadInput{"FractionalResolution",
                 "render.resolution=[64.5, 48]",
                 {": /render/resolution: ", "integers"}},
        BadInput{"ZeroSamples", "render.spp=0", {": /render/spp: ", "out of range"}},
        BadInput{"NegativeSeed", "render.seed=-1", {": /render/seed: ", "out of range"}},
        BadInput{"FieldOfView", "camera.vertical_fov=180", {": /camera/vertical_fov: ", "179"}},
        BadInput{
            "CameraLooksAtItself", "camera.look_at=[0, 1, 6]", {": /camera/look_at: ", "position"}},
        BadInput{"CameraUp", "camera.up=[0, 1, 6]", {": /camera/up: ", "parallel"}},
        BadInput{"UnknownCamera", "camera.type=fisheye", {": /camera/type: ", "perspective"}},
        BadInput{"UnknownMaterialType",
                 "materials.white.type=difuse",
                 {": /materials/0/type: ", "did you mean \"diffuse\"", "conductor"}},
        BadInput{"KeyOfAnotherMaterial",
                 "materials.metal.ior=1.5",
                 {": /materials/1/ior: ", "conductor"}},
        BadInput{"AlbedoAboveOne",
                 "materials.white.color=[2, 0, 0]",
                 {": /materials/0/color/0: ", "between 0 and 1"}},
        BadInput{"RoughnessRange",
                 "materials.metal.roughness=2",
                 {": /materials/1/roughness: ", "between 0 and 1"}},
        BadInput{
            "RepeatedMaterial",
            R"(materials=[{"name": "white", "type": "diffuse"}, {"name": "metal", "type": "conductor"}, {"name": "glass", "type": "dielectric"}, {"name": "white", "type": "diffuse"}])",
            {": /materials/3/name: ", "white"}},
        BadInput{"UnknownMaterial",
                 "instances.0.material=whit",
                 {": /instances/0/material: ", "did you mean \"white\"", "white, metal, glass"}},
        BadInput{"UnknownDetachedMaterial",
                 "instances.0.detached_material=red",
                 {": /instances/0/detached_material: ", "white, metal, glass"}},
        BadInput{"DetachedMeshMaterial",
                 "instances.1.detached_material=white",
                 {": /instances/1/detached_material: ", "rectangle"}},
        BadInput{
            "UnknownGeometry",
            "instances.0.geometry=rook",
            {": /instances/0/geometry: ", "did you mean \"rock\"", "rock, floor, triangle, ball"}},
        BadInput{
            "FlatInstance", "instances.0.scale=[1, 0, 1]", {": /instances/0/scale: ", "flatten"}},
        BadInput{"TransformAndScale",
                 "instances.2.transform=[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]",
                 {": /instances/2/rotate: ", "transform"}},
        BadInput{"TransformShape",
                 "instances.0.transform=[1, 2]",
                 {": /instances/0/transform: ", "4 rows"}},
        BadInput{"TransformFarAway",
                 "instances.0.transform=[[1,0,0,1e7],[0,1,0,0],[0,0,1,0],[0,0,0,1]]",
                 {": /instances/0/transform/0/3: ", "10000000", "between -1000000 and 1000000"}},
        BadInput{"InstanceFarAway",
                 "instances.0.translate=[0, -2e300, 0]",
                 {": /instances/0/translate/1: ", "-2e+300", "between -1000000 and 1000000"}},
        BadInput{"TransformLastRow",
                 "instances.0.transform=[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,1,1]]",
                 {": /instances/0/transform/3: ", "0 0 0 1"}},
        BadInput{"UnknownGeometryType",
                 "geometries.ball.type=cube",
                 {": /geometries/3/type: ", "hypertexture, mesh, rectangle, sphere"}},
        BadInput{"RepeatedGeometry", "geometries.3.name=rock", {": /geometries/3/name: ", "rock"}},
        BadInput{"GeometryWithoutName", "geometries.3.name=", {": /geometries/3/name: ", "empty"}},
        BadInput{"MeshMissing",
                 "geometries.triangle.file=gone.obj",
                 {": /geometries/2/file: ", "gone.obj", "no such file"}},
        BadInput{"MeshFormat",
                 "geometries.triangle.file=scene.json",
                 {": /geometries/2/file: ", "scene.json", ".obj, .ply"}},
        BadInput{"RectangleSize",
                 "geometries.floor.size=[1, 0]",
                 {": /geometries/1/size/1: ", "above 0"}},
        BadInput{
            "UnknownKeep", "geometries.rock.keep=biggest", {": /geometries/0/keep: ", "largest"}},
        BadInput{"UnknownDensity",
                 "geometries.rock.field.density.type=sphare",
                 {": /geometries/0/field/density/type: ", "did you mean \"sphere\""}},
        BadInput{"TwoEnvironments",
                 R"(lights.1={"type": "environment"})",
                 {": /lights/1: ", "at most one"}},
        BadInput{"UnknownLight",
                 "lights.1.type=spot",
                 {": /lights/1/type: ", "environment, sky, rectangle"}},
        BadInput{"EnvironmentMissing", "lights.0.file=sky.exr", {": /lights/0/file: ", "sky.exr"}},
        BadInput{"NegativeRadiance",
                 "lights.0.radiance=-1",
                 {": /lights/0/radiance: ", "between 0", "-1"}},
        BadInput{
            "LightWithoutArea", "lights.1.edge_v=[2, 0, 0]", {": /lights/1/edge_v: ", "parallel"}},
        BadInput{
            "SkewLight", "lights.1.edge_v=[1, 0, 1]", {": /lights/1/edge_v: ", "perpendicular"}},
        BadInput{"LightTwice", "lights.1.position=[0, 0, 0]", {": /lights/1: ", "exclude"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

TEST_F(SceneLoaderTest, CheckFindsEveryProblem) {
  const std::vector<std::string> problems =
      check_scene(small_scene(),
                  parse({"render.spp=0", "materials.metal.ior=2", "instances.3.material=steel",
                         "geometries.triangle.file=gone.obj"}),
                  options());
  ASSERT_EQ(problems.size(), 4u);
  EXPECT_NE(problems[0].find("/render/spp"), std::string::npos);
  EXPECT_NE(problems[1].find("/materials/1/ior"), std::string::npos);
  EXPECT_NE(problems[2].find("/instances/3/material"), std::string::npos);
  EXPECT_NE(problems[3].find("/geometries/2/file"), std::string::npos);
}

// What is wrong with one thing is not told again of what uses it.
TEST_F(SceneLoaderTest, ProblemsDoNotBringOthers) {
  const std::filesystem::path file = folder_.write("scene.json", R"({
    "morsel": 1,
    "textures": [{"type": "chekcer", "name": "squares"}],
    "materials": [{"type": "diffuse", "name": "tiled", "color_texture": "squares"}],
    "geometries": [{"type": "sphere", "name": "ball"}],
    "instances": [{"geometry": "ball", "material": "tield"}],
    "lights": [{"type": "environment"}]})");
  const std::vector<std::string> problems = check_scene(file, {}, options());
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_NE(problems[0].find("/textures/0/type"), std::string::npos) << problems[0];
  EXPECT_NE(problems[1].find("/instances/0/material"), std::string::npos) << problems[1];
  EXPECT_TRUE(warnings_.empty()) << warnings_[0];
}

TEST_F(SceneLoaderTest, TexturesOfOneNameAreRefused) {
  const std::filesystem::path file = folder_.write("scene.json", R"({
    "morsel": 1,
    "textures": [{"type": "checker", "name": "a"}, {"type": "checker", "name": "a"}]})");
  const std::vector<std::string> problems = check_scene(file, {}, options());
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].find("/textures/1/name: \"a\" is the name of another"), std::string::npos)
      << problems[0];
}
TEST_F(SceneLoaderTest, FilesThatAreNoScenesAreNamed) {
  const auto error_of = [&](const std::filesystem::path& file) {
    try {
      load_scene(file, {}, options());
    } catch (const params::InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(error_of(folder_ / "gone.json").find("gone.json"), std::string::npos);
  EXPECT_NE(error_of(folder_.path()).find("directory"), std::string::npos);
  EXPECT_NE(error_of(folder_.write("a.json", "{\n \"morsel\": 1\n 2}")).find("line 3"),
            std::string::npos);
  EXPECT_NE(error_of(folder_.write("b.json", "[]")).find("b.json"), std::string::npos);
  EXPECT_NE(error_of(folder_.write("c.json", "{}")).find("\"morsel\": 1"), std::string::npos);
  EXPECT_NE(error_of(folder_.write("d.json", R"({"morsel": 1, "camera": {"vertical_fov": 1e999}})"))
                .find("d.json"),
            std::string::npos);
}

TEST_F(SceneLoaderTest, BrokenMeshIsNamed) {
  folder_.write("triangle.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n");
  const std::filesystem::path scene = small_scene();
  try {
    load_scene(scene, {}, options());
    FAIL() << "accepted";
  } catch (const params::InputError& e) {
    const std::string what = e.what();
    EXPECT_NE(what.find("/geometries/2/file"), std::string::npos) << what;
    EXPECT_NE(what.find("triangle.obj"), std::string::npos) << what;
  }
}

TEST_F(SceneLoaderTest, ImagesAreCheckedBeforeAnythingIsBuilt) {
  folder_.write("sky.exr", "not an image");
  LoadOptions load_options = options();
  std::filesystem::path asked;
  load_options.check_image = [&](const std::filesystem::path& file) {
    asked = file;
    throw std::runtime_error("no image");
  };
  EXPECT_THROW(load_scene(small_scene(), parse({"lights.0.file=sky.exr"}), load_options),
               params::InputError);
  EXPECT_EQ(asked, folder_ / "sky.exr");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "scene.cache"));
}
}  // namespace
}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "hypertexture_geom/embree/geometry.h"
#include "renderer/scene/scene_identity.h"
#include "scene_loader_fixture.h"

namespace morsel::render {
namespace {

using nlohmann::json;

// What a checkpoint is compared by; a scene need not have a section "render".
TEST_F(SceneLoaderTest, IdentityIsOfWhatDecidesThePixels) {
  const auto identity_of = [&](const char* text, bool with_spp = false) {
    const std::filesystem::path file = folder_.write("other.json", text);
    return scene_identity(file, {}, load_scene(file, {}, options()), with_spp);
  };
  const json none = identity_of(R"({"morsel": 1})");
  EXPECT_EQ(none, identity_of(R"({"morsel": 1, "render": {"spp": 4, "exposure": 1}})"));
  EXPECT_NE(none, identity_of(R"({"morsel": 1, "render": {"max_depth": 2}})"));
  EXPECT_NE(identity_of(R"({"morsel": 1})", true),
            identity_of(R"({"morsel": 1, "render": {"spp": 4}})", true));
}

TEST_F(SceneLoaderTest, ReadsOneOfEverything) {
  const LoadedScene loaded = load();
  const Scene& scene = loaded.scene;
  EXPECT_EQ(scene.settings.width, 64);
  EXPECT_EQ(scene.settings.height, 48);
  EXPECT_EQ(scene.settings.spp, 2);
  EXPECT_EQ(scene.settings.max_depth, 3);
  EXPECT_EQ(scene.settings.seed, 7u);
  EXPECT_FLOAT_EQ(scene.settings.exposure, 0.5f);
  EXPECT_EQ(scene.camera.position, Imath::V3f(0, 1, 6));
  EXPECT_FLOAT_EQ(scene.camera.vertical_fov, 30);

  ASSERT_EQ(scene.materials.size(), 3u);
  EXPECT_EQ(scene.materials[0].type, MaterialType::kDiffuse);
  ASSERT_TRUE(scene.materials[0].checker_color);
  EXPECT_EQ(*scene.materials[0].checker_color, Imath::V3f(0.1f));
  EXPECT_EQ(scene.materials[1].type, MaterialType::kConductor);
  EXPECT_FLOAT_EQ(scene.materials[1].roughness, 0.1f);
  EXPECT_EQ(scene.materials[2].type, MaterialType::kDielectric);
  EXPECT_FLOAT_EQ(scene.materials[2].ior, 1.33f);

  ASSERT_EQ(scene.geometries.size(), 4u);
  ASSERT_EQ(scene.instances.size(), 4u);
  EXPECT_EQ(scene.instances[0].name, "rock");
  ASSERT_TRUE(scene.instances[0].detached_material);
  EXPECT_EQ(*scene.instances[0].detached_material, 2u);
  EXPECT_EQ(scene.instances[1].name, "ground");
  EXPECT_FALSE(scene.instances[1].detached_material);
  EXPECT_EQ(scene.instances[2].material, 1u);

  ASSERT_TRUE(scene.environment);
  EXPECT_EQ(scene.environment->radiance, Imath::V3f(0.1f, 0.2f, 0.3f));
  EXPECT_FLOAT_EQ(scene.environment->rotation, 30);
  ASSERT_EQ(scene.rectangles.size(), 1u);
  EXPECT_EQ(scene.rectangles[0].edge_v, Imath::V3f(0, 0, 2));
  EXPECT_EQ(scene.rectangles[0].radiance, Imath::V3f(5));
  EXPECT_FALSE(scene.rectangles[0].visible_to_camera);
  EXPECT_TRUE(warnings_.empty()) << warnings_[0];
}

TEST_F(SceneLoaderTest, MeshesAndPrimitivesAreTriangles) {
  const LoadedScene loaded = load();
  const auto& floor = std::get<TriangleMesh>(loaded.scene.geometries[1].shape);
  EXPECT_EQ(floor.triangles.size(), 2u);
  EXPECT_EQ(floor.positions[1], Imath::V3f(2, 0, 3));
  const auto& triangle = std::get<TriangleMesh>(loaded.scene.geometries[2].shape);
  EXPECT_EQ(triangle.triangles.size(), 1u);
  EXPECT_EQ(triangle.normals.size(), 3u);  // smooth by default
  const auto& ball = std::get<TriangleMesh>(loaded.scene.geometries[3].shape);
  for (const Imath::V3f& p : ball.positions) EXPECT_NEAR(p.length(), 0.5f, 1e-6f);
}

TEST_F(SceneLoaderTest, FacetsStayWhenSmoothIsOff) {
  const LoadedScene loaded = load({"geometries.triangle.smooth=false"});
  EXPECT_TRUE(std::get<TriangleMesh>(loaded.scene.geometries[2].shape).normals.empty());
}

TEST_F(SceneLoaderTest, HypertextureGetsItsCacheWrittenAndReadAgain) {
  const LoadedScene first = load();
  ASSERT_EQ(first.hypertextures.size(), 1u);
  EXPECT_TRUE(first.hypertextures[0].built);
  EXPECT_EQ(first.hypertextures[0].components, 1u);
  EXPECT_EQ(first.hypertextures[0].kept, 1u);
  EXPECT_TRUE(first.hypertextures[0].certified);
  EXPECT_TRUE(std::filesystem::exists(first.hypertextures[0].cache_file));
  EXPECT_EQ(first.hypertextures[0].cache_file.parent_path(), folder_ / "scene.cache");
  const LoadedScene second = load();
  EXPECT_FALSE(second.hypertextures[0].built);
  EXPECT_EQ(second.hypertextures[0].bricks, first.hypertextures[0].bricks);
}

TEST_F(SceneLoaderTest, UnusedGeometryIsNotBuiltAndTheRestIsRenumbered) {
  const LoadedScene loaded = load({R"(instances=[{"geometry": "ball", "material": "glass"}])"});
  ASSERT_EQ(loaded.scene.geometries.size(), 1u);
  EXPECT_EQ(loaded.scene.geometries[0].name, "ball");
  EXPECT_EQ(loaded.scene.instances[0].geometry, 0u);
  EXPECT_TRUE(loaded.hypertextures.empty());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "scene.cache"));
  EXPECT_EQ(warnings_.size(), 3u);
}

TEST_F(SceneLoaderTest, NothingKeptIsWarnedOf) {
  load({"geometries.rock.keep=detached"});
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_NE(warnings_[0].find("detached"), std::string::npos) << warnings_[0];
}

TEST_F(SceneLoaderTest, CancelStopsTheBuildAndLeavesNothing) {
  std::atomic<bool> cancel{true};
  LoadOptions load_options = options();
  load_options.execution.cancel = &cancel;
  EXPECT_THROW(load_scene(small_scene(), {}, load_options), topology::Cancelled);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "scene.cache"));
  // Making bricks of labels that are there can take as long as the labels did.
  load();
  EXPECT_THROW(load_scene(small_scene(), {}, load_options), topology::Cancelled);
  cancel = false;
  bool bricks = false;
  load_options.execution.progress = [&](double, const std::string& phase) {
    bricks = bricks || phase == "bricks";
  };
  load_scene(small_scene(), {}, load_options);
  EXPECT_TRUE(bricks);
}

TEST_F(SceneLoaderTest, SaysWhenNothingShines) {
  const auto dark = [&](const std::vector<std::string>& set) {
    warnings_.clear();
    load(set);
    const auto says = [](const std::string& warning) {
      return warning.find("/lights: nothing shines") != std::string::npos;
    };
    EXPECT_LE(std::count_if(warnings_.begin(), warnings_.end(), says), 1);
    return std::any_of(warnings_.begin(), warnings_.end(), says);
  };
  EXPECT_FALSE(dark({}));
  EXPECT_TRUE(dark({"lights=[]"}));
  EXPECT_TRUE(dark({"lights=[{\"type\": \"environment\", \"radiance\": 0}]"}));
  for (const char* light :
       {R"({"type": "environment"})", R"({"type": "sky"})",
        R"({"type": "rectangle", "position": [0, 3, 0], "look_at": [0, 0, 0], "size": [1, 1]})",
        R"({"type": "disk", "position": [0, 3, 0], "look_at": [0, 0, 0]})",
        R"({"type": "sphere", "position": [0, 3, 0]})",
        R"({"type": "point", "position": [0, 3, 0]})", R"({"type": "distant"})"})
    EXPECT_FALSE(dark({"lights=[" + std::string(light) + "]"})) << light;
  // A material that shines does so only where an instance has it.
  const std::string shining = R"(materials.metal={"name": "metal", "type": "principled", )"
                              R"("emission": [0, 1, 0]})";
  EXPECT_FALSE(dark({"lights=[]", shining}));
  EXPECT_TRUE(dark({"lights=[]", shining, "instances.triangle.material=white"}));
  EXPECT_FALSE(dark({"lights=[]", shining, "instances.triangle.material=white",
                     "instances.rock.detached_material=metal"}));
  // scene check says so too, unless a light is what is wrong.
  warnings_.clear();
  EXPECT_TRUE(check_scene(small_scene(), parse({"lights=[]"}), options()).empty());
  EXPECT_EQ(warnings_.size(), 1u);
  warnings_.clear();
  EXPECT_EQ(check_scene(small_scene(), parse({"lights=[{\"type\": \"lamp\"}]"}), options()).size(),
            1u);
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(SceneLoaderTest, CheckAcceptsAndBuildsNothing) {
  EXPECT_TRUE(check_scene(small_scene(), {}, options()).empty());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "scene.cache"));
}

TEST(ScenesOfTheRepository, AreValid) {
  const std::filesystem::path scenes = std::filesystem::path(MORSEL_SOURCE_DIR) / "scenes";
  int count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(scenes)) {
    if (entry.path().extension() != ".json") continue;
    ++count;
    // Deriving boxes is the only slow part and says nothing about validity: give one.
    std::vector<Override> overrides;
    for (const GeometryEntry& geometry : list_geometries(SceneDocument(entry.path(), {})))
      if (geometry.type == "hypertexture")
        overrides.push_back({"geometries." + geometry.name + ".bounds",
                             json::parse(R"({"min": [-4, -4, -4], "max": [4, 4, 4]})"), "test"});
    for (const std::string& problem : check_scene(entry.path(), overrides))
      ADD_FAILURE() << problem;
  }
  EXPECT_GE(count, 4);
}

}  // namespace
}  // namespace morsel::render

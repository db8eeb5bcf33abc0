// SPDX-License-Identifier: Apache-2.0
// Models: glTF and OBJ files with their materials, nodes, lights and cameras.
#include "renderer/scene/model.h"

#include <gtest/gtest.h>

#include <map>

#include "renderer/mesh/mesh_file.h"
#include "tests/renderer/gltf_file.h"
#include "tests/temporary_folder.h"

namespace morsel::render {
namespace {

using Imath::V2f;
using Imath::V3f;
using nlohmann::json;

class ModelTest : public ::testing::Test {
 protected:
  Model load(const std::filesystem::path& file) {
    return load_model(file, [this](const std::string& w) { warnings_.push_back(w); });
  }
  // A square with one material and one image, whose bytes nobody decodes here.
  test::GltfFile textured(const json& material) {
    test::GltfFile file;
    file.add_square();
    file.primitive()["material"] = 0;
    file.json["materials"] = {material};
    file.json["images"] = {{{"uri", "image.png"}}};
    file.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
    file.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
    folder_.write("image.png", "the bytes");
    return file;
  }
  Material material_of(const json& material) {
    const Model model = load(textured(material).write_gltf(folder_));
    textures_ = model.scene.textures;
    return model.scene.materials.at(0);
  }
  const Texture& texture(const Material& m, MaterialInput input) {
    return textures_.at(m.texture(input));
  }

  test::TemporaryFolder folder_;
  std::vector<std::string> warnings_;
  std::vector<Texture> textures_;
};

TEST_F(ModelTest, MetallicRoughness) {
  const Material m = material_of(
      {{"name", "paint"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
         {"metallicFactor", 0.7},
         {"roughnessFactor", 0.6},
         {"baseColorTexture", {{"index", 0}}},
         {"metallicRoughnessTexture", {{"index", 0}}}}},
       {"normalTexture", {{"index", 0}, {"scale", 0.5}}},
       {"emissiveFactor", {1, 0.5, 0.25}},
       {"alphaMode", "MASK"},
       {"alphaCutoff", 0.3},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}});
  EXPECT_EQ(m.type, MaterialType::kPrincipled);
  EXPECT_EQ(m.name, "paint");
  EXPECT_EQ(m.color, V3f(0.1f, 0.2f, 0.3f));
  EXPECT_FLOAT_EQ(m.metallic, 0.7f);
  EXPECT_FLOAT_EQ(m.roughness, 0.6f);
  EXPECT_FLOAT_EQ(m.opacity, 0.4f);
  EXPECT_FLOAT_EQ(m.opacity_cutoff, 0.3f);
  EXPECT_FLOAT_EQ(m.normal_scale, 0.5f);
  EXPECT_EQ(m.emission, V3f(4, 2, 1));
  const auto& color = texture(m, MaterialInput::kColor);
  const auto& image = std::get<ImageTexture>(color.kind);
  EXPECT_EQ(std::string(image.data->begin(), image.data->end()), "the bytes");
  EXPECT_EQ(image.color_space, ColorSpace::kSrgb);
  EXPECT_EQ(image.wrap_u, Wrap::kClamp);
  EXPECT_EQ(image.wrap_v, Wrap::kMirror);
  EXPECT_EQ(texture(m, MaterialInput::kRoughness).channel, TextureChannel::kGreen);
  EXPECT_EQ(texture(m, MaterialInput::kMetallic).channel, TextureChannel::kBlue);
  EXPECT_EQ(std::get<ImageTexture>(texture(m, MaterialInput::kMetallic).kind).color_space,
            ColorSpace::kLinear);
  EXPECT_EQ(texture(m, MaterialInput::kOpacity).channel, TextureChannel::kAlpha);
}

TEST_F(ModelTest, Extensions) {
  const Material m = material_of(
      {{"extensions",
        {{"KHR_materials_clearcoat",
          {{"clearcoatFactor", 0.8},
           {"clearcoatRoughnessFactor", 0.3},
           {"clearcoatTexture",
            {{"index", 0},
             {"extensions",
              {{"KHR_texture_transform",
                {{"offset", {0.25, 0.5}}, {"scale", {2, 3}}, {"rotation", 1.5707963}}}}}}}}},
         {"KHR_materials_transmission", {{"transmissionFactor", 0.9}}},
         {"KHR_materials_volume",
          {{"thicknessFactor", 1},
           {"attenuationDistance", 2},
           {"attenuationColor", {0.5, 0.6, 0.7}}}},
         {"KHR_materials_ior", {{"ior", 1.33}}},
         {"KHR_materials_sheen",
          {{"sheenColorFactor", {0.1, 0.2, 0.3}}, {"sheenRoughnessFactor", 0.4}}},
         {"KHR_materials_specular",
          {{"specularFactor", 0.5}, {"specularColorFactor", {1, 0.9, 0.8}}}}}}});
  EXPECT_FLOAT_EQ(m.clearcoat, 0.8f);
  EXPECT_FLOAT_EQ(m.clearcoat_roughness, 0.3f);
  EXPECT_FLOAT_EQ(m.transmission, 0.9f);
  EXPECT_FALSE(m.thin);
  EXPECT_FLOAT_EQ(m.attenuation_distance, 2.0f);
  EXPECT_EQ(m.attenuation_color, V3f(0.5f, 0.6f, 0.7f));
  EXPECT_TRUE(m.color_tints_volume);
  EXPECT_FLOAT_EQ(m.ior, 1.33f);
  EXPECT_EQ(m.sheen_color, V3f(0.1f, 0.2f, 0.3f));
  EXPECT_FLOAT_EQ(m.specular, 0.5f);
  EXPECT_EQ(m.specular_color, V3f(1.0f, 0.9f, 0.8f));
  const auto& image = std::get<ImageTexture>(texture(m, MaterialInput::kClearcoat).kind);
  EXPECT_EQ(image.offset, V2f(0.25f, 0.5f));
  EXPECT_EQ(image.scale, V2f(2, 3));
  EXPECT_NEAR(image.rotation, 90.0f, 1e-3f);
  EXPECT_TRUE(image.v_down);
}

TEST_F(ModelTest, TransmissionWithoutAVolumeIsASheet) {
  const Material m =
      material_of({{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}}}});
  EXPECT_TRUE(m.thin);
}

TEST_F(ModelTest, NodesAreFlattenedIntoInstances) {
  test::GltfFile file;
  file.add_square();
  file.json["nodes"] = {{{"name", "root"}, {"translation", {1, 0, 0}}, {"children", {1, 2}}},
                        {{"name", "a"}, {"mesh", 0}, {"translation", {0, 2, 0}}},
                        {{"name", "b"}, {"mesh", 0}, {"scale", {2, 2, 2}}, {"camera", 0}}};
  file.json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}};
  const Model model = load(file.write_gltf(folder_));
  ASSERT_EQ(model.scene.geometries.size(), 1u);  // shared
  ASSERT_EQ(model.scene.instances.size(), 2u);
  EXPECT_EQ(model.scene.instances[0].name, "a");
  EXPECT_EQ(Imath::V3d(0.0) * model.scene.instances[0].object_to_world, Imath::V3d(1, 2, 0));
  EXPECT_EQ(Imath::V3d(1, 1, 0) * model.scene.instances[1].object_to_world, Imath::V3d(3, 2, 0));
  ASSERT_TRUE(model.has_camera);
  EXPECT_EQ(model.scene.camera.position, V3f(1, 0, 0));
  EXPECT_NEAR((model.scene.camera.look_at - V3f(1, 0, -1)).length(), 0.0f, 1e-6f);
  EXPECT_NEAR(model.scene.camera.vertical_fov, 57.29578f, 1e-3f);
}

TEST_F(ModelTest, PunctualLights) {
  test::GltfFile file;
  file.add_square();
  file.json["nodes"] = {
      {{"mesh", 0}, {"children", {1, 2}}},
      {{"translation", {0, 3, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
      {{"rotation", {-0.70710678, 0, 0, 0.70710678}},
       {"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}}};
  file.json["extensionsUsed"] = {"KHR_lights_punctual"};
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"},
       {"color", {1, 0.5, 0}},
       {"intensity", 10},
       {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.5}}}},
      {{"type", "directional"}, {"intensity", 3}}};
  const Model model = load(file.write_gltf(folder_));
  ASSERT_EQ(model.scene.points.size(), 1u);
  EXPECT_EQ(model.scene.points[0].position, V3f(0, 3, 0));
  EXPECT_EQ(model.scene.points[0].intensity, V3f(10, 5, 0));
  EXPECT_NEAR(model.scene.points[0].outer_angle, 28.6479f, 1e-3f);
  ASSERT_EQ(model.scene.distants.size(), 1u);
  EXPECT_NEAR((model.scene.distants[0].direction - V3f(0, -1, 0)).length(), 0.0f, 1e-6f);
}

// tinygltf alone reads beyond the buffer.
TEST_F(ModelTest, ImagesAreWithinTheirBuffers) {
  const auto message = [&](const auto& change) {
    test::GltfFile file = textured({{"name", "m"}});
    const int bytes =
        file.add_accessor<std::uint8_t>({1, 2, 3, 4}, test::GltfFile::kByte, "SCALAR", 1);
    file.json["images"] = {{{"bufferView", bytes}, {"mimeType", "image/png"}}};
    change(file.json, file.json["bufferViews"][static_cast<std::size_t>(bytes)]);
    try {
      load(file.write_gltf(folder_));
    } catch (const MeshError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(message([](json&, json&) {}), "");
  for (const auto& [error, what] :
       {std::pair{message([](json&, json&view) { view["byteOffset"] = 100; }),
                  "/images/0 ends at byte 104 of a buffer that has"},
        {message([](json&, json&view) { view["byteLength"] = 1e300; }), "/images/0 ends at byte"},
        {message([](json&, json&view) { view["buffer"] = 1; }),
         "/images/0/bufferView/buffer is 1, but there are 1 buffers"},
        {message([](json&, json&view) { view.erase("buffer"); }), "without a buffer"},
        {message([](json&file, json&) { file["images"][0]["bufferView"] = 9; }),
         "/images/0/bufferView is 9, but there are 3 bufferViews"}}) {
    EXPECT_NE(error.find(what), std::string::npos) << error;
    EXPECT_NE(error.find("mesh.gltf"), std::string::npos) << error;
  }
}

TEST_F(ModelTest, SaysWhatIsWrongWithAFile) {
  const auto message = [&](const json& material, const auto& change) {
    test::GltfFile file = textured(material);
    change(file);
    try {
      load(file.write_gltf(folder_));
    } catch (const MeshError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const json uses = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}};
  EXPECT_EQ(message(uses, [](auto&) {}), "");
  const std::string missing =
      message(uses, [](auto& f) { f.json["images"][0]["uri"] = "nowhere.png"; });
  EXPECT_NE(missing.find("mesh.gltf"), std::string::npos) << missing;
  EXPECT_NE(missing.find("nowhere.png"), std::string::npos) << missing;
  const std::string texture = message({{"normalTexture", {{"index", 7}}}}, [](auto&) {});
  EXPECT_NE(texture.find("texture 7"), std::string::npos) << texture;
  const std::string material = message(uses, [](auto& f) { f.primitive()["material"] = 5; });
  EXPECT_NE(material.find("material 5"), std::string::npos) << material;
}

TEST_F(ModelTest, ObjWithMtl) {
  folder_.write("image.png", "bytes");
  folder_.write("square.mtl",
                "newmtl shiny\nKd 0.2 0.4 0.6\nKs 0.5 0.5 0.5\nNs 98\nd 0.75\nmap_Kd image.png\n"
                "newmtl lamp\nKd 0 0 0\nKe 3 2 1\n");
  const auto file =
      folder_.write("square.obj",
                    "mtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\n"
                    "vt 1 1\nusemtl shiny\nf 1/1 2/2 3/3\nusemtl lamp\nf 1/1 3/3 4/2\n");
  const Model model = load(file);
  ASSERT_EQ(model.scene.instances.size(), 2u);
  const Scene& scene = model.scene;
  const Material& shiny = scene.materials[scene.instances[0].material];
  EXPECT_EQ(shiny.name, "shiny");
  EXPECT_NEAR((shiny.color - V3f(0.2f, 0.4f, 0.6f)).length(), 0.0f, 1e-6f);
  EXPECT_NEAR(shiny.opacity, 0.75f, 1e-6f);
  EXPECT_NEAR(shiny.specular, 0.5f, 1e-6f);
  EXPECT_NEAR(shiny.roughness, std::pow(2.0f / 100.0f, 0.25f), 1e-5f);
  const auto& image =
      std::get<ImageTexture>(scene.textures.at(shiny.texture(MaterialInput::kColor)).kind);
  EXPECT_NE(image.file.find("image.png"), std::string::npos);
  const Material& lamp = scene.materials[scene.instances[1].material];
  EXPECT_NEAR((lamp.emission - V3f(3, 2, 1)).length(), 0.0f, 1e-6f);
}

TEST_F(ModelTest, PlacementMovesEverythingAndKeepsIndicesRight) {
  test::GltfFile file =
      textured({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  const auto path = file.write_gltf(folder_);
  Scene scene;
  for (int k = 0; k < 2; ++k) {
    ModelPlacement placement;
    placement.name = std::string("m") + std::to_string(k);
    placement.transform.setTranslation(Imath::V3d(k, 0, 0));
    add_model(load(path), placement, scene);
  }
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[1].geometry, 1u);
  EXPECT_EQ(scene.instances[1].material, 2u);
  EXPECT_EQ(scene.materials[2].texture(MaterialInput::kColor), 1u);
  EXPECT_EQ(Imath::V3d(0.0) * scene.instances[1].object_to_world, Imath::V3d(1, 0, 0));
  EXPECT_EQ(scene.instances[0].name.rfind("m0/", 0), 0u);
}

TEST_F(ModelTest, SecondCoordinatesAndColors) {
  test::GltfFile file = textured({{"pbrMetallicRoughness",
                                   {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}},
                                    {"metallicRoughnessTexture", {{"index", 0}}}}}});
  auto& attributes = file.primitive()["attributes"];
  attributes["TEXCOORD_0"] =
      file.add_accessor<float>({0, 0, 1, 0, 1, 1, 0, 1}, test::GltfFile::kFloat, "VEC2", 2);
  attributes["TEXCOORD_1"] = file.add_accessor<std::uint16_t>(
      {0, 0, 65535, 0, 65535, 65535, 0, 65535}, test::GltfFile::kShort, "VEC2", 2);
  file.json["accessors"].back()["normalized"] = true;
  attributes["COLOR_0"] = file.add_accessor<std::uint8_t>(
      {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 51, 51, 51, 255}, test::GltfFile::kByte,
      "VEC4", 4);
  file.json["accessors"].back()["normalized"] = true;
  const Model model = load(file.write_gltf(folder_));
  const auto& mesh = std::get<TriangleMesh>(model.scene.geometries.at(0).shape);
  ASSERT_EQ(mesh.uvs1.size(), 4u);
  EXPECT_EQ(mesh.uvs1[2], V2f(1, 0));
  ASSERT_EQ(mesh.colors.size(), 4u);
  EXPECT_EQ(mesh.colors[1], V3f(0, 1, 0));
  EXPECT_NEAR(mesh.colors[3].x, 0.2f, 1e-6f);
  textures_ = model.scene.textures;
  const Material& m = model.scene.materials[0];
  const auto& color = std::get<ImageTexture>(texture(m, MaterialInput::kColor).kind);
  const auto& roughness = std::get<ImageTexture>(texture(m, MaterialInput::kRoughness).kind);
  EXPECT_EQ(color.uv_set, 1);
  EXPECT_EQ(roughness.uv_set, 0);
  EXPECT_EQ(color.data, roughness.data) << "the bytes are kept once";
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(ModelTest, WarnsOfWhatItLeavesOut) {
  const auto warned = [&](const std::string& part) {
    for (const std::string& w : warnings_)
      if (w.find(part) != std::string::npos) return true;
    return false;
  };
  test::GltfFile file = textured({{"name", "soap"},
                                  {"normalTexture", {{"index", 0}}},
                                  {"extensions", {{"KHR_materials_iridescence", json::object()}}}});
  file.json["textures"] = {{{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}};
  file.json["nodes"].push_back({{"name", "hidden"}, {"mesh", 0}, {"scale", {0, 0, 0}}});
  file.json["scenes"][0]["nodes"].push_back(1);
  file.json["animations"] = {{{"channels", json::array()}, {"samplers", json::array()}}};
  const Model model = load(file.write_gltf(folder_));
  EXPECT_EQ(model.scene.instances.size(), 1u);
  EXPECT_TRUE(warned("\"soap\": the extension KHR_materials_iridescence"));
  EXPECT_TRUE(warned("texture 0 of material \"soap\""));
  EXPECT_TRUE(warned("KHR_texture_basisu"));
  EXPECT_TRUE(warned("\"hidden\""));
  EXPECT_TRUE(warned("animations"));
  warnings_.clear();
  const char* triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  folder_.write("some.mtl", "newmtl red\nKd 1 0 0\n");
  load(folder_.write("a.obj",
                     std::string("mtllib some.mtl\n") + triangle + "usemtl blue\nf 1 2 3\n"));
  EXPECT_TRUE(warned("usemtl blue")) << "no such material";
  load(folder_.write("b.obj", std::string("mtllib other.mtl\n") + triangle + "f 1 2 3\n"));
  EXPECT_TRUE(warned("mtllib other.mtl"));
  warnings_.clear();
  load(folder_.write("c.obj",
                     std::string("mtllib some.mtl\n") + triangle + "usemtl red\nf 1 2 3\n"));
  EXPECT_TRUE(warnings_.empty());
}

// Real files, where Debian's package assimp-testmodels is installed.
constexpr const char* kRealModels = "/usr/share/assimp/models/";

class RealModels : public ModelTest {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kRealModels)) GTEST_SKIP() << "assimp-testmodels is not installed";
  }
};

TEST_F(RealModels, AreRead) {
  for (const char* name :
       {"glTF2/BoxTextured-glTF/BoxTextured.gltf",
        "glTF2/BoxTextured-glTF-Embedded/BoxTextured.gltf",
        "glTF2/BoxTextured-glTF-Binary/BoxTextured.glb",
        "glTF2/BoxTextured-glTF-pbrSpecularGlossiness/BoxTextured.gltf",
        "glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb",
        "glTF2/ClearCoat-glTF/ClearCoatTest.gltf",
        "glTF2/textureTransform/TextureTransformTest.gltf", "glTF2/cameras/Cameras.gltf",
        "OBJ/WusonOBJ.obj", "OBJ/spider.obj", "OBJ/cube_usemtl.obj"}) {
    const Model model = load(std::string(kRealModels) + name);
    EXPECT_FALSE(model.scene.instances.empty()) << name;
    for (const Instance& i : model.scene.instances) {
      EXPECT_LT(i.material, model.scene.materials.size()) << name;
      EXPECT_LT(i.geometry, model.scene.geometries.size()) << name;
    }
  }
  EXPECT_TRUE(load(std::string(kRealModels) + "glTF2/cameras/Cameras.gltf").has_camera);
}

TEST_F(RealModels, ThatAreBrokenSayHow) {
  for (const auto& [name, what] : std::map<std::string, std::string>{
           {"glTF2/IndexOutOfRange/IndexOutOfRange.gltf", "index 0 is 255"},
           {"glTF2/MissingBin/BoxTextured.gltf", "BoxTextured0.bin"},
           {"glTF2/RecursiveNodes/RecursiveNodes.gltf", "node 0 is reached twice"},
           {"glTF2/wrongTypes/badArray.gltf", "/meshes/0/primitives must be an array"},
           {"glTF2/wrongTypes/badNumber.gltf", "must be"},
           {"glTF2/wrongTypes/badObject.gltf", "must be"},
           {"glTF2/wrongTypes/badString.gltf", "/scenes/0/name must be a string, not 42"},
           {"glTF2/wrongTypes/badUint.gltf", "must be"},
           {"glTF2/wrongTypes/badExtension.gltf", "must be"},
           {"glTF2/SchemaFailures/sceneWrongType.gltf", "must be"},
           {"glTF2/BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb", "not a finite number"},
           {"glTF/BoxTextured-glTF/BoxTextured.gltf", "only 2 is supported"},
           {"invalid/malformed.obj", "line 23: there is no vertex 12"},
           {"invalid/malformed2.obj", "f names no vertex"},
           {"invalid/empty.obj", ""}}) {
    try {
      load(kRealModels + name);
      FAIL() << name;
    } catch (const MeshError& e) {
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find(what), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
// Models of our own, from the file to the picture: what real glTF and OBJ files are made of.
#include <Imath/ImathBox.h>
#include <Imath/ImathVec.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <tuple>

#include "renderer/integrator/render.h"
#include "renderer/mesh/mesh_file.h"
#include "renderer/scene/model.h"
#include "tests/renderer/gltf_file.h"
#include "tests/renderer/test_scenes.h"
#include "tests/temporary_folder.h"

namespace morsel::render {
namespace {

using namespace testing;
using nlohmann::json;
using test::GltfFile;

constexpr int kSide = 32;

// Red and green above blue and white, with the bytes of a PNG.
std::string quadrants(const test::TemporaryFolder& folder) {
  const std::string file = (folder.path() / "quadrants.png").string();
  std::vector<unsigned char> pixels;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const bool right = x >= 32, below = y >= 32;
      pixels.push_back(right == below ? 255 : 0);
      pixels.push_back(right ? 255 : 0);
      pixels.push_back(below ? 255 : 0);
    }
  auto out = OIIO::ImageOutput::create(file);
  out->open(file, OIIO::ImageSpec(64, 64, 3, OIIO::TypeDesc::UINT8));
  out->write_image(OIIO::TypeDesc::UINT8, pixels.data());
  out->close();
  std::ifstream in(file, std::ios::binary);
  std::stringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
}
// `x`, `y` in [0, 1] from the top left corner.
V3f quadrant(float x, float y) {
  if (y < 0.5f) return x < 0.5f ? V3f(1, 0, 0) : V3f(0, 1, 0);
  return x < 0.5f ? V3f(0, 0, 1) : V3f(1, 1, 1);
}

std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : digits[word >> (18 - 6 * k) & 63u];
  }
  return text;
}

class ModelRender : public ::testing::Test {
 protected:
  // A textured square that fills the picture: the mesh spans [0, 1]^2, its node moves it by
  // (-1, -1), the node above that makes it twice as large, and another one turns it.
  GltfFile square(const json& material) {
    GltfFile file;
    file.add_square();
    file.primitive()["material"] = 0;
    file.primitive()["attributes"]["TEXCOORD_0"] =
        file.add_accessor<float>({0, 1, 1, 1, 1, 0, 0, 0}, GltfFile::kFloat, "VEC2", 2);
    file.json["materials"] = {material};
    file.json["textures"] = {{{"source", 0}}};
    file.json["images"] = {{{"uri", "quadrants.png"}}};
    file.json["nodes"] = {{{"name", "turned"}, {"children", {1}}, {"rotation", {0, 0, 1, 0}}},
                          {{"name", "twice"},
                           {"children", {2, 3}},
                           {"matrix", {-2, 0, 0, 0, 0, -2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1}}},
                          {{"name", "square"}, {"mesh", 0}, {"translation", {-0.5, -0.5, 0}}},
                          {{"name", "eye"}, {"camera", 0}, {"translation", {0, 0, 2}}}};
    file.json["cameras"] = {
        {{"type", "orthographic"},
         {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 9}}}}};
    return file;
  }

  Film picture(const std::filesystem::path& file) {
    Scene scene;
    ModelPlacement placement;
    placement.camera = true;
    add_model(load_model(file, [](const std::string& w) { ADD_FAILURE() << w; }), placement, scene);
    add_constant_environment(scene, 1.0f);
    set_image(scene, kSide, kSide, 4, 2);
    return render(scene).film;
  }

  // Away from the border between the quadrants, which is interpolated.
  template <class Value>
  static void expect_quadrants(const Film& film, Value&& value) {
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const auto border = [](int i) {
          return i == 0 || i == kSide - 1 || i == kSide / 2 || i == kSide / 2 - 1;
        };
        if (border(x) || border(y)) continue;
        const V3f expected = quadrant((static_cast<float>(x) + 0.5f) / kSide,
                                      (static_cast<float>(y) + 0.5f) / kSide);
        ASSERT_NEAR((value(film.at(x, y)) - expected).length(), 0.0f, 0.01f) << x << ", " << y;
      }
  }

  test::TemporaryFolder folder_;
  std::string png_ = quadrants(folder_);
  const json unlit_ = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                       {"extensions", {{"KHR_materials_unlit", json::object()}}}};
};

TEST_F(ModelRender, ImagesMayBeFilesTextOrInBuffers) {
  GltfFile file = square(unlit_);
  const Film by_file = picture(file.write_gltf(folder_));
  expect_quadrants(by_file, [](const Pixel& p) { return p.color; });

  std::vector<Film> others;
  file.json["images"] = {{{"uri", "data:image/png;base64," + base64(png_)}}};
  others.push_back(picture(file.write_gltf(folder_)));
  file.add_accessor(std::vector<char>(png_.begin(), png_.end()), GltfFile::kByte, "SCALAR", 1);
  file.json["images"] = {
      {{"bufferView", file.json["bufferViews"].size() - 1}, {"mimeType", "image/png"}}};
  others.push_back(picture(file.write_gltf(folder_)));
  others.push_back(picture(file.write_glb(folder_)));
  for (const Film& other : others)
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) ASSERT_EQ(other.at(x, y).color, by_file.at(x, y).color);
}

TEST_F(ModelRender, TexturesAreTransformedAsTheExtensionSays) {
  // Half a repetition to the right: what was left is right. v is counted from the top.
  json material = unlit_;
  material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"offset", {0.5, 0.0}}};
  const Film moved = picture(square(material).write_gltf(folder_));
  const int quarter = kSide / 4;
  EXPECT_NEAR((moved.at(quarter, quarter).color - V3f(0, 1, 0)).length(), 0.0f, 0.01f);
  // Counter-clockwise by a quarter about the top left corner: the quadrant to the right is above.
  material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"rotation", 1.5707963}};
  const Film turned = picture(square(material).write_gltf(folder_));
  // (u, v) becomes (v, -u) = (0.25, -0.25): blue, from the repetition above.
  EXPECT_NEAR((turned.at(quarter, quarter).color - V3f(0, 0, 1)).length(), 0.0f, 0.01f);
}

TEST_F(ModelRender, TheSecondCoordinatesAndVertexColorsCount) {
  json material = unlit_;
  material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 1;
  GltfFile file = square(material);
  auto& attributes = file.primitive()["attributes"];
  attributes["TEXCOORD_1"] = attributes["TEXCOORD_0"];
  attributes["TEXCOORD_0"] =
      file.add_accessor<float>({0, 0, 0, 0, 0, 0, 0, 0}, GltfFile::kFloat, "VEC2", 2);
  expect_quadrants(picture(file.write_gltf(folder_)), [](const Pixel& p) { return p.color; });

  GltfFile painted =
      square({{"pbrMetallicRoughness", {{"roughnessFactor", 1}, {"metallicFactor", 0}}},
              {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}});
  painted.primitive()["attributes"]["COLOR_0"] = painted.add_accessor<float>(
      {0.5, 0, 0, 0.5, 0, 0, 0.5, 1, 0, 0.5, 1, 0}, GltfFile::kFloat, "VEC3", 3);
  const Film film = picture(painted.write_gltf(folder_));
  for (int y = 1; y < kSide - 1; ++y) {
    const float up = 1.0f - (static_cast<float>(y) + 0.5f) / kSide;
    EXPECT_NEAR((film.at(kSide / 3, y).albedo - V3f(0.5f, up, 0)).length(), 0.0f, 0.02f);
  }
}

// From the top's 0 to the bottom's 1; what is opaque stays so.
TEST_F(ModelRender, AlphaOfVertexColorsCutsAndFades) {
  const auto top_and_bottom = [&](const char* mode) {
    GltfFile file = square({{"pbrMetallicRoughness", json::object()}, {"alphaMode", mode}});
    file.primitive()["attributes"]["COLOR_0"] = file.add_accessor<float>(
        {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 1, 1, 1, 0}, GltfFile::kFloat, "VEC4", 4);
    const Film film = picture(file.write_gltf(folder_));
    const auto mean = [&](int y0) {
      float sum = 0.0f;
      for (int y = y0; y < y0 + 8; ++y)
        for (int x = 0; x < kSide; ++x)
          sum += film.at(x, y).geometric_normal.length() / (8.0f * kSide);
      return sum;
    };
    return std::pair(mean(0), mean(kSide - 8));
  };
  EXPECT_EQ(top_and_bottom("OPAQUE"), std::pair(1.0f, 1.0f));
  EXPECT_EQ(std::minmax({top_and_bottom("MASK").first, top_and_bottom("MASK").second}),
            std::pair(0.0f, 1.0f));
  const auto [a, b] = top_and_bottom("BLEND");
  EXPECT_NEAR(std::min(a, b), 0.125f, 0.08f);
  EXPECT_NEAR(std::max(a, b), 0.875f, 0.08f);
}

TEST_F(ModelRender, MasksCutAndSheetsAreSeenFromBothSides) {
  json material = {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.3}}}},
                   {"alphaMode", "MASK"},
                   {"doubleSided", true}};
  EXPECT_EQ(picture(square(material).write_gltf(folder_)).at(5, 5).geometric_normal, V3f(0.0f));
  material["alphaCutoff"] = 0.2;
  EXPECT_NEAR(picture(square(material).write_gltf(folder_)).at(5, 5).geometric_normal.z, 1.0f,
              1e-6f);
}

TEST_F(ModelRender, AnObjHasTheTexturesOfItsMaterials) {
  folder_.write("square.mtl", "newmtl paper\nKd 1 1 1\nKs 0 0 0\nmap_Kd quadrants.png\n");
  Scene scene;
  ModelPlacement placement;
  add_model(load_model(folder_.write("square.obj",
                                     "mtllib square.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
                                     "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl paper\n"
                                     "f 1/1 2/2 3/3 4/4\n"),
                       [](const std::string& w) { ADD_FAILURE() << w; }),
            placement, scene);
  scene.camera.projection = Projection::kOrthographic;
  scene.camera.height = 2.0f;
  add_constant_environment(scene, 1.0f);
  set_image(scene, kSide, kSide, 4, 2);
  expect_quadrants(render(scene).film, [](const Pixel& p) { return p.albedo; });
}

TEST_F(ModelRender, WhatIsNoImageIsNamed) {
  GltfFile file = square(unlit_);
  for (const bool cut : {false, true}) {
    folder_.write("quadrants.png", cut ? png_.substr(0, 40) : std::string("not a picture"));
    const auto path = file.write_gltf(folder_);
    try {
      picture(path);
      ADD_FAILURE() << "accepted";
    } catch (const std::runtime_error& e) {
      EXPECT_NE(std::string(e.what()).find(path.string()), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("image 0 (quadrants.png)"), std::string::npos)
          << e.what();
    }
  }
}

// Files that others made, from the package assimp-testmodels: whole, in view, lit by a white sky.
constexpr const char* kRealModels = "/usr/share/assimp/models/";

struct RealModel {
  const char* file;
  bool textured;  // in colour
};
void PrintTo(const RealModel& model, std::ostream* out) { *out << model.file; }

class RealModelRender : public ::testing::TestWithParam<RealModel> {};

void look_at_all(Scene& scene) {
  Imath::Box3d bounds;
  for (const Instance& i : scene.instances)
    for (const V3f& p : std::get<TriangleMesh>(scene.geometries[i.geometry].shape).positions)
      bounds.extendBy(V3d(p) * i.object_to_world);
  const V3d middle = bounds.center(), half = bounds.size() * 0.5;
  scene.camera = {};
  scene.camera.look_at = V3f(middle);
  scene.camera.position = V3f(middle + V3d(0.45, 0.35, 0.82) * (3.0 * half.length()));
}

TEST_P(RealModelRender, IsSeenWithoutErrors) {
  const std::string file = std::string(kRealModels) + GetParam().file;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "assimp-testmodels is not installed";
  Scene scene;
  add_model(load_model(file, [](const std::string&) {}), {.name = "model", .transform = {}}, scene);
  look_at_all(scene);
  add_constant_environment(scene, 1.0f);
  scene.environment->visible_to_camera = false;
  set_image(scene, kSide, kSide, 4);
  const RenderResult result = render(scene);
  EXPECT_EQ(result.statistics.non_finite_samples, 0u);
  int covered = 0;
  std::set<std::tuple<float, float, float>> albedos;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const Pixel& p = result.film.at(x, y);
      if (p.alpha < 1.0f) continue;
      ++covered;
      albedos.emplace(p.albedo.x, p.albedo.y, p.albedo.z);
      EXPECT_GT(max_component(p.color), 0.0f) << x << ", " << y;
    }
  EXPECT_GT(covered, kSide * kSide / 25);
  // One material has one albedo, but for where its gloss depends on the angle.
  if (GetParam().textured) {
    EXPECT_GT(albedos.size(), 20u);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Files, RealModelRender,
    ::testing::Values(RealModel{"glTF2/BoxTextured-glTF/BoxTextured.gltf", true},
                      RealModel{"glTF2/BoxTextured-glTF-Embedded/BoxTextured.gltf", true},
                      RealModel{"glTF2/BoxTextured-glTF-Binary/BoxTextured.glb", true},
                      RealModel{"glTF2/BoxTextured-glTF-pbrSpecularGlossiness/BoxTextured.gltf",
                                true},
                      RealModel{"glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb", false},
                      RealModel{"glTF2/ClearCoat-glTF/ClearCoatTest.gltf", false},
                      RealModel{"glTF2/textureTransform/TextureTransformTest.gltf", true},
                      RealModel{"glTF2/cameras/Cameras.gltf", false},
                      RealModel{"OBJ/WusonOBJ.obj", false}, RealModel{"OBJ/spider.obj", true},
                      RealModel{"OBJ/cube_usemtl.obj", false}));

}  // namespace
}  // namespace morsel::render

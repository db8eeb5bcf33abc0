// SPDX-License-Identifier: Apache-2.0
// Smoothing groups of OBJ files: which facets share normals.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "renderer/mesh/mesh_file.h"
#include "renderer/scene/model.h"
#include "tests/temporary_folder.h"

namespace morsel::render {
namespace {

using Imath::V3f;

// A roof of two squares that meet at a right angle along the y axis: the left one faces -x, the
// right one +x, both up. `before_left` and `before_right` are lines.
std::string roof(const std::string& before_left, const std::string& before_right) {
  return "v -1 0 -1\nv 0 0 0\nv 0 1 0\nv -1 1 -1\nv 1 0 -1\nv 1 1 -1\nvt 0 0\n" + before_left +
         "f 1 2 3 4\n" + before_right + "f 2/1 5/1 6/1 3/1\n";
}
const V3f kLeft = V3f(-1, 0, 1).normalized(), kRight = V3f(1, 0, 1).normalized(), kUp(0, 0, 1);

// The normals at the ridge, of the left and of the right square.
struct Ridge {
  V3f left{0.0f}, right{0.0f};
};
Ridge ridge_of(const TriangleMesh& mesh) {
  Ridge ridge;
  for (const Imath::V3i& t : mesh.triangles) {
    float x = 0.0f;
    for (int k = 0; k < 3; ++k) x += mesh.positions[static_cast<std::size_t>(t[k])].x;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(t[k]);
      if (mesh.positions[i].x == 0.0f) (x < 0.0f ? ridge.left : ridge.right) = mesh.normals.at(i);
    }
  }
  return ridge;
}

struct RoofCase {
  const char* name;
  std::string before_left, before_right;
  V3f left, right;
};
void PrintTo(const RoofCase& c, std::ostream* out) { *out << c.name; }
class Roof : public ::testing::TestWithParam<RoofCase> {};

TEST_P(Roof, FacetsOfAGroupShareNormals) {
  const RoofCase& c = GetParam();
  const test::TemporaryFolder folder;
  const auto file = folder.write("roof.obj", roof(c.before_left, c.before_right));
  const TriangleMesh mesh = load_mesh(file);
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_NEAR((ridge_of(mesh).left - c.left).length(), 0.0f, 1e-6f) << ridge_of(mesh).left;
  EXPECT_NEAR((ridge_of(mesh).right - c.right).length(), 0.0f, 1e-6f) << ridge_of(mesh).right;
  const Model model = load_model(file, {});
  ASSERT_EQ(model.scene.geometries.size(), 1u);
  const auto& of_model = std::get<TriangleMesh>(model.scene.geometries[0].shape);
  EXPECT_NEAR((ridge_of(of_model).left - c.left).length(), 0.0f, 1e-6f);
  EXPECT_NEAR((ridge_of(of_model).right - c.right).length(), 0.0f, 1e-6f);
}

INSTANTIATE_TEST_SUITE_P(
    Groups, Roof,
    ::testing::Values(RoofCase{"one", "s 1\n", "", kUp, kUp},
                      RoofCase{"two", "s 1\n", "s 2\n", kLeft, kRight},
                      RoofCase{"the_same_again", "s 7\n", "s off\ns 7\n", kUp, kUp},
                      RoofCase{"off", "s off\n", "", kLeft, kRight},
                      RoofCase{"zero", "s 0\n", "", kLeft, kRight},
                      RoofCase{"none_before_the_first", "", "s 1\n", kLeft, kRight}),
    [](const auto& p) { return p.param.name; });

TEST(ObjGroups, FilesWithoutThemHaveNoNormals) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(load_mesh(folder.write("plain.obj", roof("", ""))).normals.empty());
}

// Every facet of a file whose smoothing is off is flat, however many there are, and normals that
// the file gives stay.
TEST(ObjGroups, ManyFlatFacets) {
  constexpr int kSide = 260;  // more facets than 16 bits count
  std::string text = "s off\nvn 1 0 0\n";
  for (int y = 0; y <= kSide; ++y)
    for (int x = 0; x <= kSide; ++x)
      text += "v " + std::to_string(x) + " " + std::to_string(y) + " " +
              std::to_string((x * 7 + y * 5 + x * y) % 3) + "\n";
  text += "f 1//1 2//1 " + std::to_string(kSide + 2) + "//1\n";
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const int a = y * (kSide + 1) + x + 1, c = a + kSide + 1;
      text += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(c + 1) +
              "\n";
    }
  const test::TemporaryFolder folder;
  const TriangleMesh mesh = load_mesh(folder.write("flat.obj", text));
  ASSERT_EQ(mesh.triangles.size(), 1u + kSide * kSide);
  int given = 0;
  for (const Imath::V3i& t : mesh.triangles) {
    V3f p[3];
    for (int k = 0; k < 3; ++k) p[k] = mesh.positions[static_cast<std::size_t>(t[k])];
    const V3f n = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    given += mesh.normals[static_cast<std::size_t>(t.x)] == V3f(1, 0, 0);
    if (mesh.normals[static_cast<std::size_t>(t.x)] == V3f(1, 0, 0)) continue;
    for (int k = 0; k < 3; ++k)
      ASSERT_NEAR((mesh.normals[static_cast<std::size_t>(t[k])] - n).length(), 0.0f, 1e-5f);
  }
  EXPECT_EQ(given, 1);
}

// Assimp reads the rewritten file, and finds materials beside the true one.
TEST(ObjGroups, MaterialsAreStillFound) {
  const test::TemporaryFolder folder;
  folder.write("paint.mtl", "newmtl red\nKd 1 0 0\n");
  const auto file =
      folder.write("roof.obj", "mtllib paint.mtl\nusemtl red\n" + roof("s 1\n", "s 2\n"));
  std::string warnings;
  const Model model = load_model(file, [&](const std::string& text) { warnings += text; });
  EXPECT_EQ(warnings, "");
  const auto material = model.scene.instances.at(0).material;
  EXPECT_EQ(model.scene.materials.at(material).color, V3f(1, 0, 0));
}

}  // namespace
}  // namespace morsel::render

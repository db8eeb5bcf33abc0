// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "gltf_file.h"
#include "renderer/mesh/mesh_file.h"
#include "renderer/mesh/normals.h"
#include "renderer/mesh/primitives.h"
#include "tests/temporary_folder.h"

namespace morsel::render {
namespace {

using Imath::V3f;
using test::GltfFile;
using test::TemporaryFolder;

V3f face_normal(const TriangleMesh& mesh, std::size_t t) {
  const V3f& a = mesh.positions[static_cast<std::size_t>(mesh.triangles[t].x)];
  const V3f& b = mesh.positions[static_cast<std::size_t>(mesh.triangles[t].y)];
  const V3f& c = mesh.positions[static_cast<std::size_t>(mesh.triangles[t].z)];
  return (b - a).cross(c - a).normalized();
}

// Six times the enclosed volume; positive when triangles are wound outward.
double signed_volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Imath::V3i& t : mesh.triangles) {
    const Imath::V3d a(mesh.positions[static_cast<std::size_t>(t.x)]);
    const Imath::V3d b(mesh.positions[static_cast<std::size_t>(t.y)]);
    const Imath::V3d c(mesh.positions[static_cast<std::size_t>(t.z)]);
    sum += a.dot(b.cross(c));
  }
  return sum;
}

void expect_error(const std::filesystem::path& file, const std::string& part) {
  try {
    load_mesh(file);
    ADD_FAILURE() << file << " was accepted";
  } catch (const MeshError& e) {
    const std::string what = e.what();
    EXPECT_NE(what.find(file.string()), std::string::npos) << what;
    EXPECT_NE(what.find(part), std::string::npos) << "\"" << part << "\" in " << what;
  }
}

TEST(Mesh, BunnyHasItsVerticesAndTriangles) {
  const TriangleMesh mesh =
      load_mesh(std::filesystem::path(MORSEL_SOURCE_DIR) / "scenes/assets/bunny.obj");
  EXPECT_EQ(mesh.positions.size(), 1839u);
  EXPECT_EQ(mesh.triangles.size(), 3674u);
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_TRUE(mesh.uvs.empty());
  EXPECT_GT(signed_volume(mesh), 0);
}

TEST(Mesh, SmoothNormalsOfTheBunnyPointOutward) {
  TriangleMesh mesh =
      load_mesh(std::filesystem::path(MORSEL_SOURCE_DIR) / "scenes/assets/bunny.obj");
  const std::vector<V3f> normals = smooth_normals(mesh);
  ASSERT_EQ(normals.size(), mesh.positions.size());
  std::size_t against = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const V3f& n = normals[static_cast<std::size_t>(mesh.triangles[t][i])];
      EXPECT_NEAR(n.length(), 1, 1e-5);
      against += n.dot(face_normal(mesh, t)) <= 0 ? 1 : 0;
    }
  EXPECT_LT(against, mesh.triangles.size() / 100);
}

TEST(Mesh, NormalsAreWeightedByAngle) {
  // A cube's corner, one of whose faces is cut into two triangles: the normal must not lean to it.
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {0, 4, 3}};
  const V3f n = smooth_normals(mesh)[0];
  EXPECT_NEAR((n - V3f(-1, -1, -1).normalized()).length(), 0, 1e-6);
}

TEST(Mesh, NormalsHaveNoSeamsWhereVerticesAreDoubled) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {3, 5, 4}};
  const std::vector<V3f> normals = smooth_normals(mesh);
  EXPECT_EQ(normals[0], normals[3]);
  EXPECT_EQ(normals[2], normals[4]);
  EXPECT_NE(normals[1], normals[0]);
}

TEST(Mesh, NormalsOfOpposedOrDegenerateFacesAreUnit) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}, {0, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}, {3, 3, 3}};
  for (const V3f& n : smooth_normals(mesh)) EXPECT_NEAR(n.length(), 1, 1e-6);
}

TEST(Mesh, ObjKeepsNormalsAndTextureCoordinates) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = load_mesh(folder.write("a.obj",
                                                   "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                                   "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                                                   "vn 0 0 5\n"
                                                   "f 1/1/1 2/2/1 3/3/1 4/4/1\n"));
  ASSERT_EQ(mesh.triangles.size(), 2u);
  ASSERT_EQ(mesh.positions.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(mesh.normals[i], V3f(0, 0, 1));
    EXPECT_EQ(mesh.uvs[i], Imath::V2f(mesh.positions[i].x, mesh.positions[i].y));
  }
}

TEST(Mesh, ZeroNormalsBecomeSmoothOnes) {
  const TemporaryFolder folder;
  const TriangleMesh mesh =
      load_mesh(folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 0\nf 1//1 2//1 3//1\n"));
  ASSERT_EQ(mesh.normals.size(), 3u);
  for (const V3f& n : mesh.normals) EXPECT_EQ(n, V3f(0, 0, 1));
}

constexpr char kPlyHeader[] =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

TEST(Mesh, ReadsPly) {
  const TemporaryFolder folder;
  const TriangleMesh mesh =
      load_mesh(folder.write("a.ply", std::string(kPlyHeader) + "3 0 1 2\n3 0 2 3\n"));
  EXPECT_EQ(mesh.positions.size(), 4u);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(face_normal(mesh, 0), V3f(0, 0, 1));
}

TEST(Mesh, ReadsStlInCapitals) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = load_mesh(folder.write(
      "A.STL",
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\nendsolid a\n"));
  EXPECT_EQ(mesh.triangles.size(), 1u);
}

TEST(Mesh, BrokenFilesAreNamed) {
  const TemporaryFolder folder;
  expect_error(folder / "gone.obj", "no such file");
  expect_error(folder.path(), "directory");
  expect_error(folder.write("a.fbx", "x"), ".obj, .ply, .stl, .gltf, .glb");
  expect_error(folder.write("a.obj", "this is no mesh\n"), "");
  expect_error(folder.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "");
  expect_error(folder.write("range.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n"), "");
  expect_error(folder.write("nan.obj", "v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
               "line 1: \"nan\"");
  expect_error(folder.write("empty.ply", ""), "");
  expect_error(folder.write("short.ply", std::string(kPlyHeader)), "");
  expect_error(folder.write("range.ply", std::string(kPlyHeader) + "3 0 1 2\n3 0 2 9\n"), "");
  expect_error(folder.write("a.gltf", "{"), "");
  expect_error(folder.write("a.glb", "glTFxxxxxxxxxxxxxxxxxxxx"), "");
}

TEST(Mesh, NumbersOfAnObjFileAreChecked) {
  const TemporaryFolder folder;
  const std::string rest = "v 1 0 0\nv 0 1 0\nf 1 2 3\n";
  // Assimp alone reads the first of these as another triangle.
  for (const auto& [line, word] : {std::pair{"v 1 0 nan", "nan"},
                                   {"v 0 0 inf", "inf"},
                                   {"v 0 0 1e999", "1e999"},
                                   {"v 0 0 1x", "1x"},
                                   {"vn 0 NaN 1\nv 0 0 0", "NaN"},
                                   {"vt - 0\nv 0 0 0", "-"}})
    expect_error(folder.write("bad.obj", "# made by hand\n" + std::string(line) + "\n" + rest),
                 "line 2: \"" + std::string(word) + "\" is not a finite number");
  for (const char* line : {"v +0 0 1e-999\r", "v 0 \\\n 0 0", "v 0 0 0 1", "v 0 0 0 0.5 0.5 0.5"})
    EXPECT_EQ(load_mesh(folder.write("good.obj", std::string(line) + "\n" + rest)).triangles.size(),
              1u)
        << line;
}

TEST(Mesh, IndicesOfAnObjFileAreChecked) {
  const TemporaryFolder folder;
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n";
  for (const auto& [face, what] :
       {std::pair{"f 1 2 5", "line 7: there is no vertex 5; the file has 4 before"},
        {"f 1/1 2/2 3/1", "line 7: there is no texture coordinate 2; the file has 1 before"},
        {"f 1//1 2//1 3//9", "line 7: there is no normal 9; the file has 1"},
        {"f 1 2 -5", "line 7: there is no vertex -5; the file has 4 before this line"},
        {"f 0 1 2", "line 7: \"0\": indices count from 1"},
        {"f 1 2 three", "line 7: \"three\" is not a corner"},
        {"f 1/1/1/1 2 3", "line 7: \"1/1/1/1\" has too many slashes"},
        {"f", "line 7: f names no vertex"},
        {"v 1 2", "line 7: v has 2 numbers, but needs 3"},
        {"f 1 2 99999999999999999999", "is not a corner"}})
    expect_error(folder.write("bad.obj", square + face + "\nf 1 2 3\n"), what);
  // Backwards, and with continued lines.
  for (const char* face : {"f -4 -3 -2", "f 1 \\\n2 3"})
    EXPECT_EQ(load_mesh(folder.write("good.obj", square + face + "\n")).triangles.size(), 1u)
        << face;
}

TEST(Mesh, ValidationFindsWhatReadersLeave) {
  TriangleMesh mesh;
  EXPECT_THROW(validate_mesh(mesh, "f"), MeshError);
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_NO_THROW(validate_mesh(mesh, "f"));
  mesh.triangles = {{0, 1, -1}};
  EXPECT_THROW(validate_mesh(mesh, "f"), MeshError);
  mesh.triangles = {{0, 1, 3}};
  EXPECT_THROW(validate_mesh(mesh, "f"), MeshError);
  mesh.triangles = {{0, 1, 2}};
  mesh.positions[1].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(validate_mesh(mesh, "f"), MeshError);
  mesh.positions[1].y = 0;
  mesh.normals = {{0, 0, 1}};
  EXPECT_THROW(validate_mesh(mesh, "f"), MeshError);
}

template <class Index>
void expect_square(int index_type) {
  const TemporaryFolder folder;
  GltfFile file;
  file.add_square<Index>(index_type);
  for (const auto& path : {file.write_gltf(folder), file.write_glb(folder)}) {
    const TriangleMesh mesh = load_mesh(path);
    EXPECT_EQ(mesh.positions.size(), 4u);
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(face_normal(mesh, 0), V3f(0, 0, 1));
    EXPECT_EQ(face_normal(mesh, 1), V3f(0, 0, 1));
    EXPECT_TRUE(mesh.normals.empty());
  }
}

TEST(Gltf, ReadsIndicesOfEveryType) {
  expect_square<std::uint8_t>(GltfFile::kByte);
  expect_square<std::uint16_t>(GltfFile::kShort);
  expect_square<std::uint32_t>(GltfFile::kInt);
}

TEST(Gltf, ReadsPrimitivesWithoutIndicesStripsAndFans) {
  const TemporaryFolder folder;
  const auto triangles = [&](int mode, const std::vector<std::uint16_t>& indices) {
    GltfFile file;
    file.add_square();
    file.primitive()["mode"] = mode;
    if (indices.empty())
      file.primitive().erase("indices");
    else
      file.primitive()["indices"] =
          file.add_accessor<std::uint16_t>(indices, GltfFile::kShort, "SCALAR", 1);
    return load_mesh(file.write_gltf(folder));
  };
  EXPECT_EQ(triangles(4, {}).triangles.size(), 1u);  // the fourth vertex is left over
  for (const TriangleMesh& mesh : {triangles(5, {0, 1, 3, 2}), triangles(6, {0, 1, 2, 3})}) {
    ASSERT_EQ(mesh.triangles.size(), 2u);
    for (std::size_t t = 0; t < 2; ++t) EXPECT_EQ(face_normal(mesh, t), V3f(0, 0, 1));
  }
}

TEST(Gltf, AppliesTheTransformsOfNodes) {
  const TemporaryFolder folder;
  GltfFile file;
  file.add_square();
  file.json["nodes"] = nlohmann::json::parse(R"([
    {"children": [1, 2], "translation": [10, 0, 0]},
    {"mesh": 0, "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476], "scale": [2, 1, 1]},
    {"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]}])");
  const TriangleMesh mesh = load_mesh(file.write_gltf(folder));
  ASSERT_EQ(mesh.positions.size(), 8u);
  // (1, 0, 0) scaled by 2 along x, a quarter turn about z, then moved.
  EXPECT_NEAR((mesh.positions[1] - V3f(10, 2, 0)).length(), 0, 1e-6);
  EXPECT_EQ(mesh.positions[5], V3f(11, 0, 5));
  EXPECT_EQ(mesh.triangles.size(), 4u);
}

TEST(Gltf, MirroringKeepsTrianglesFacingAlongTheirNormals) {
  const TemporaryFolder folder;
  GltfFile file;
  file.add_square();
  file.primitive()["attributes"]["NORMAL"] =
      file.add_accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, GltfFile::kFloat, "VEC3", 3);
  file.json["nodes"] = nlohmann::json::parse(R"([{"mesh": 0, "scale": [-1, 1, 4]}])");
  const TriangleMesh mesh = load_mesh(file.write_gltf(folder));
  EXPECT_EQ(mesh.positions[1], V3f(-1, 0, 0));
  EXPECT_EQ(face_normal(mesh, 0), V3f(0, 0, 1));
  EXPECT_EQ(mesh.normals[0], V3f(0, 0, 1));
}

TEST(Gltf, TextureCoordinatesPointUp) {
  const TemporaryFolder folder;
  GltfFile file;
  file.add_square();
  file.primitive()["attributes"]["TEXCOORD_0"] =
      file.add_accessor<std::uint8_t>({0, 255, 255, 255, 255, 0, 0, 0}, GltfFile::kByte, "VEC2", 2);
  file.json["accessors"].back()["normalized"] = true;
  const TriangleMesh mesh = load_mesh(file.write_gltf(folder));
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(mesh.uvs[i], Imath::V2f(mesh.positions[i].x, mesh.positions[i].y));
}

TEST(Gltf, HostileFilesAreErrors) {
  const TemporaryFolder folder;
  const auto expect_refused = [&](const std::string& part,
                                  const std::function<void(GltfFile&)>& spoil) {
    GltfFile file;
    file.add_square();
    spoil(file);
    expect_error(file.write_gltf(folder), part);
  };
  expect_refused("beyond its buffer", [](GltfFile& f) { f.json["accessors"][0]["count"] = 5; });
  expect_refused("beyond its buffer",
                 [](GltfFile& f) { f.json["accessors"][0]["count"] = 4000000000000000ll; });
  expect_refused("beyond its buffer",
                 [](GltfFile& f) { f.json["accessors"][0]["byteOffset"] = 4000000000ll; });
  expect_refused("beyond its buffer",
                 [](GltfFile& f) { f.json["bufferViews"][0]["byteOffset"] = 100000; });
  expect_refused("", [](GltfFile& f) { f.json["bufferViews"][0]["byteLength"] = 100000; });
  expect_refused("", [](GltfFile& f) { f.json["bufferViews"][0]["buffer"] = 7; });
  expect_refused("", [](GltfFile& f) { f.json["accessors"][0]["bufferView"] = 7; });
  expect_refused("", [](GltfFile& f) { f.primitive()["attributes"]["POSITION"] = 7; });
  expect_refused("", [](GltfFile& f) { f.primitive()["indices"] = 7; });
  expect_refused("node 0", [](GltfFile& f) { f.json["nodes"][0]["children"] = {0}; });
  expect_refused("node 9", [](GltfFile& f) { f.json["nodes"][0]["children"] = {9}; });
  expect_refused("mesh 9", [](GltfFile& f) { f.json["nodes"][0]["mesh"] = 9; });
  expect_refused("version \"1.0\"", [](GltfFile& f) { f.json["asset"]["version"] = "1.0"; });
  expect_refused("no triangles", [](GltfFile& f) { f.primitive()["mode"] = 1; });
  expect_refused("KHR_draco", [](GltfFile& f) {
    f.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  });
  for (const char* name : {"EXT_meshopt_compression", "KHR_texture_basisu", "NO_such"})
    expect_refused("requires the extension " + std::string(name),
                   [&](GltfFile& f) { f.json["extensionsRequired"] = {name}; });
  expect_refused("mesh 0, primitive 0: is compressed by KHR_draco", [](GltfFile& f) {
    f.primitive()["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
    f.json["accessors"][0].erase("bufferView");
  });
  expect_refused("accessor 0 has 4000000000 elements and no bufferView", [](GltfFile& f) {
    f.json["accessors"][0].erase("bufferView");
    f.json["accessors"][0]["count"] = 4000000000ll;
  });
  expect_refused("node 0 has a matrix whose last row", [](GltfFile& f) {
    f.json["nodes"][0]["matrix"] = {1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  });
  expect_refused("4 NORMAL, but 3 POSITION", [](GltfFile& f) {
    f.primitive()["attributes"]["NORMAL"] = f.primitive()["attributes"]["POSITION"];
    f.primitive()["attributes"]["POSITION"] =
        f.add_accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0}, GltfFile::kFloat, "VEC3", 3);
  });
  expect_refused("accessor 0 must be a vector of 3 numbers",
                 [](GltfFile& f) { f.json["accessors"][0]["type"] = "VEC2"; });
  expect_refused("mode 9", [](GltfFile& f) { f.primitive()["mode"] = 9; });
  expect_refused("nested deeper", [](GltfFile& f) {
    nlohmann::json deep = 1;
    for (int i = 0; i < 300; ++i) deep = nlohmann::json::array({deep});
    f.json["extras"] = deep;
  });
  // What is of the wrong type.
  expect_refused("/accessors/0/count must be a whole number, 0 or more, not \"four\"",
                 [](GltfFile& f) { f.json["accessors"][0]["count"] = "four"; });
  expect_refused("/accessors must be an array, not 7",
                 [](GltfFile& f) { f.json["accessors"] = 7; });
  expect_refused("/meshes/0/primitives must be an array, not {\"mode\":4}", [](GltfFile& f) {
    f.json["meshes"][0]["primitives"] = {{"mode", 4}};
  });
  expect_refused("/nodes must be an array, not \"none\"",
                 [](GltfFile& f) { f.json["nodes"] = "none"; });
  expect_refused("/scenes/0/nodes must be an array of whole numbers, 0 or more, not [\"zero\"]",
                 [](GltfFile& f) { f.json["scenes"][0]["nodes"] = {"zero"}; });
  expect_refused("/nodes/0/mesh must be a whole number, 0 or more, not -1",
                 [](GltfFile& f) { f.json["nodes"][0]["mesh"] = -1; });
  expect_refused("/nodes/0/scale must be an array of numbers, not 2",
                 [](GltfFile& f) { f.json["nodes"][0]["scale"] = 2; });
  expect_refused("/materials/0/alphaMode must be a string", [](GltfFile& f) {
    f.json["materials"] = {{{"alphaMode", 3}}};
  });
  expect_refused("KHR_texture_transform/offset must be an array of numbers", [](GltfFile& f) {
    f.json["materials"] = {
        {{"normalTexture",
          {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"offset", 1}}}}}}}}};
  });
  expect_refused("", [](GltfFile& f) { f.json["scene"] = 5; });
  expect_refused("mesh 0, primitive 0: index 2 is 4, but there are 4 vertices", [](GltfFile& f) {
    f.primitive()["indices"] =
        f.add_accessor<std::uint16_t>({0, 1, 4}, GltfFile::kShort, "SCALAR", 1);
  });
  expect_refused("not a finite number", [](GltfFile& f) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    f.primitive()["attributes"]["POSITION"] =
        f.add_accessor<float>({0, 0, 0, 1, nan, 0, 1, 1, 0, 0, 1, 0}, GltfFile::kFloat, "VEC3", 3);
  });
}

TEST(Gltf, FilesCutShortAreErrors) {
  const TemporaryFolder folder;
  GltfFile file;
  file.add_square();
  const auto gltf = file.write_gltf(folder);
  const auto bin = folder.path() / "mesh.bin";
  std::filesystem::resize_file(bin, std::filesystem::file_size(bin) - 3);
  expect_error(gltf, "mesh.bin");
  std::filesystem::remove(bin);
  expect_error(gltf, "mesh.bin");
  for (std::uintmax_t bytes : {4, 12, 19, 20, 60, 200}) {
    const auto glb = file.write_glb(folder);
    ASSERT_GT(std::filesystem::file_size(glb), bytes);
    std::filesystem::resize_file(glb, bytes);
    expect_error(glb, "");
  }
  const auto glb = file.write_glb(folder);
  std::filesystem::resize_file(glb, std::filesystem::file_size(glb) - 4);
  expect_error(glb, "");
}

TEST(Gltf, ReadsSparseAccessors) {
  const TemporaryFolder folder;
  GltfFile file;
  file.add_square();
  const int places = file.add_accessor<std::uint16_t>({1, 2}, GltfFile::kShort, "SCALAR", 1);
  const int values = file.add_accessor<float>({5, 0, 0, 5, 6, 0}, GltfFile::kFloat, "VEC3", 3);
  auto& accessors = file.json["accessors"];
  const auto sparse = [&](int count) {
    return nlohmann::json{
        {"count", count},
        {"indices",
         {{"bufferView", accessors[static_cast<std::size_t>(places)]["bufferView"]},
          {"componentType", GltfFile::kShort}}},
        {"values", {{"bufferView", accessors[static_cast<std::size_t>(values)]["bufferView"]}}}};
  };
  accessors[0]["sparse"] = sparse(2);
  TriangleMesh mesh = load_mesh(file.write_gltf(folder));
  EXPECT_EQ(mesh.positions[0], V3f(0, 0, 0));
  EXPECT_EQ(mesh.positions[1], V3f(5, 0, 0));
  EXPECT_EQ(mesh.positions[2], V3f(5, 6, 0));
  EXPECT_EQ(mesh.positions[3], V3f(0, 1, 0));
  // Zeros where there is nothing else.
  const nlohmann::json view = accessors[0]["bufferView"];
  accessors[0].erase("bufferView");
  mesh = load_mesh(file.write_gltf(folder));
  EXPECT_EQ(mesh.positions[3], V3f(0, 0, 0));
  EXPECT_EQ(mesh.positions[2], V3f(5, 6, 0));
  accessors[0]["bufferView"] = view;
  accessors[0]["sparse"] = sparse(3);
  expect_error(file.write_gltf(folder), "mesh 0, primitive 0: accessor 0, sparse indices,");
  accessors[0]["sparse"] = sparse(2);
  accessors[0]["count"] = 2;
  expect_error(file.write_gltf(folder), "sparse index 1 is 2");
}

TEST(Gltf, ReadsQuantizedPositions) {
  const TemporaryFolder folder;
  GltfFile file;
  file.add_square();
  file.json["extensionsRequired"] = file.json["extensionsUsed"] = {"KHR_mesh_quantization"};
  file.primitive()["attributes"]["POSITION"] = file.add_accessor<std::int16_t>(
      {0, 0, 0, 32767, 0, 0, 32767, -32767, 0, 0, 16384, 0}, 5122, "VEC3", 3);
  file.json["accessors"].back()["normalized"] = true;
  TriangleMesh mesh = load_mesh(file.write_gltf(folder));
  EXPECT_EQ(mesh.positions[2], V3f(1, -1, 0));
  EXPECT_NEAR(mesh.positions[3].y, 0.5f, 1e-4f);
  file.json["accessors"].back()["normalized"] = false;
  mesh = load_mesh(file.write_gltf(folder));
  EXPECT_EQ(mesh.positions[2], V3f(32767, -32767, 0));
}

TEST(Gltf, MissingTexturesAreNoObstacle) {
  const TemporaryFolder folder;
  GltfFile file;
  file.add_square();
  file.json["images"] = {{{"uri", "gone.png"}}};
  EXPECT_EQ(load_mesh(file.write_gltf(folder)).triangles.size(), 2u);
}

TEST(Primitives, SphereIsClosedAndFacesOutward) {
  const TriangleMesh mesh = make_sphere(2, 64);
  EXPECT_NEAR(signed_volume(mesh) / 6, 4.0 / 3 * 3.14159265 * 8, 0.2);
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    EXPECT_NEAR((mesh.positions[i] - mesh.normals[i] * 2).length(), 0, 1e-6);
  // Every edge has a twin the other way round, by position: poles and the seam close exactly.
  std::map<std::array<float, 6>, int> edges;
  for (const Imath::V3i& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const V3f& a = mesh.positions[static_cast<std::size_t>(t[i])];
      const V3f& b = mesh.positions[static_cast<std::size_t>(t[(i + 1) % 3])];
      ++edges[{a.x, a.y, a.z, b.x, b.y, b.z}];
    }
  for (const auto& [e, count] : edges) {
    const auto twin = edges.find({e[3], e[4], e[5], e[0], e[1], e[2]});
    ASSERT_TRUE(twin != edges.end());
    EXPECT_EQ(count, 1);
  }
  validate_mesh(mesh, "sphere");
}

TEST(Primitives, RectangleFacesUp) {
  const TriangleMesh mesh = make_rectangle({2, 6});
  for (std::size_t t = 0; t < 2; ++t) EXPECT_EQ(face_normal(mesh, t), V3f(0, 1, 0));
  EXPECT_EQ(mesh.positions[0], V3f(-1, 0, 3));
}

}  // namespace
}  // namespace morsel::render

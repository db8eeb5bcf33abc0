// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "command_scene.h"
#include "renderer/mesh/mesh_file.h"
#include "run_command.h"

namespace morsel::test {
namespace {

using nlohmann::json;

class MeshCommandTest : public ::testing::Test {
 protected:
  CommandResult mesh(const std::string& scene, std::vector<std::string> more) {
    std::vector<std::string> arguments{"mesh", scene};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_morsel(arguments);
  }

  TemporaryFolder folder_;
  std::string ball_ = folder_.write("ball.json", kBallScene).string();
  std::string rock_ = folder_.write("rock.json", kCommandScene).string();
  std::string ply_ = (folder_ / "out.ply").string();
  std::string glb_ = (folder_ / "out.glb").string();
};

TEST_F(MeshCommandTest, BallAsPly) {
  const CommandResult result =
      mesh(ball_, {"--geometry", "ball", "--error", "0.001", "-o", ply_, "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json info = json::parse(result.out);
  EXPECT_EQ(info["certified"], true);
  EXPECT_LE(info["error_bound"], 0.001);
  ASSERT_EQ(info["components"].size(), 1u);
  EXPECT_EQ(info["components"][0]["euler_characteristic"], 2);

  // Byte by byte, as the header says.
  std::ifstream in(ply_, std::ios::binary);
  std::stringstream all;
  all << in.rdbuf();
  const std::string text = all.str(), end = "end_header\n";
  const std::size_t data = text.find(end) + end.size();
  const std::size_t vertices = info["vertices"], triangles = info["triangles"];
  EXPECT_NE(text.find("element vertex " + std::to_string(vertices) + "\n"), std::string::npos);
  ASSERT_EQ(text.size(), data + 28 * vertices + 13 * triangles);
  for (std::size_t i = 0; i < vertices; ++i) {
    float x[6];
    std::uint32_t component;
    std::memcpy(x, text.data() + data + 28 * i, 24);
    std::memcpy(&component, text.data() + data + 28 * i + 24, 4);
    const float r = std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    ASSERT_NEAR(r, std::sqrt(1.0 - 1e-4), 1e-3);
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(x[3 + k], x[k] / r, 1e-5);
    ASSERT_EQ(component, 0u);
  }
  // And by a reader that others use.
  const render::TriangleMesh read = render::load_mesh(ply_);
  EXPECT_EQ(read.triangles.size(), triangles);
}

// As much of the format as `morsel mesh` writes.
render::TriangleMesh read_obj(const std::string& text) {
  render::TriangleMesh mesh;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind, a, b, c;
    words >> kind >> a >> b >> c;
    if (kind == "v") mesh.positions.emplace_back(std::stof(a), std::stof(b), std::stof(c));
    if (kind == "vn") mesh.normals.emplace_back(std::stof(a), std::stof(b), std::stof(c));
    if (kind == "f")
      mesh.triangles.emplace_back(std::stoi(a) - 1, std::stoi(b) - 1, std::stoi(c) - 1);
  }
  return mesh;
}

TEST_F(MeshCommandTest, AllFormatsHoldTheSame) {
  const std::string obj = (folder_ / "out.obj").string();
  for (const std::string& file : {ply_, glb_, obj}) {
    const CommandResult result = mesh(rock_, {"--error", "0.03", "--keep", "all", "-o", file});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_NE(result.out.find("topology certified"), std::string::npos) << result.out;
  }
  const render::TriangleMesh ply = render::load_mesh(ply_), glb = render::load_mesh(glb_);
  ASSERT_EQ(ply.triangles.size(), glb.triangles.size());
  ASSERT_EQ(ply.normals.size(), ply.positions.size());
  ASSERT_EQ(glb.normals.size(), glb.positions.size());
  for (std::size_t i = 0; i < ply.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k)
      ASSERT_EQ(ply.positions[static_cast<std::size_t>(ply.triangles[i][k])],
                glb.positions[static_cast<std::size_t>(glb.triangles[i][k])]);
  // OBJ has the triangles in the order of their components, with bit by bit the same floats.
  const std::string text = read_text(obj);
  const render::TriangleMesh read = read_obj(text);
  const auto corners_of = [](const render::TriangleMesh& mesh) {
    std::vector<std::array<float, 9>> all;
    for (const Imath::V3i& t : mesh.triangles) {
      const auto at = [&](int k) { return mesh.positions[static_cast<std::size_t>(t[k])]; };
      all.push_back(
          {at(0).x, at(0).y, at(0).z, at(1).x, at(1).y, at(1).z, at(2).x, at(2).y, at(2).z});
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_TRUE(corners_of(read) == corners_of(ply));
  ASSERT_EQ(read.positions, ply.positions);
  for (std::size_t i = 0; i < ply.normals.size(); ++i)
    ASSERT_LT((read.normals[i] - ply.normals[i]).length(), 1e-6f);  // readers normalise
  // By a reader that others use, too, whose floats are a little off.
  EXPECT_EQ(render::load_mesh(obj).triangles.size(), ply.triangles.size());
  const std::size_t first = text.find("\ng component_0\n"), second = text.find("\ng component_1\n");
  ASSERT_NE(first, std::string::npos);
  ASSERT_NE(second, std::string::npos);
  EXPECT_LT(first, second);
  EXPECT_EQ(text.find("\ng component_0\n", first + 1), std::string::npos);
  // The components are there, as the table has them.
  std::ifstream in(glb_, std::ios::binary);
  std::stringstream all;
  all << in.rdbuf();
  EXPECT_NE(all.str().find("_COMPONENT"), std::string::npos);
}

TEST_F(MeshCommandTest, KeepsWhatTheSceneKeepsUnlessToldOtherwise) {
  const auto components = [&](std::vector<std::string> more) {
    for (const char* a : {"--error", "0.05", "-o"}) more.emplace_back(a);
    more.push_back(ply_);
    more.emplace_back("--json");
    const CommandResult result = mesh(rock_, more);
    EXPECT_EQ(result.code, 0) << result.err;
    std::vector<int> ids;
    const json info = json::parse(result.out);
    for (const json& c : info["components"]) ids.push_back(c["component"]);
    return ids;
  };
  const std::vector<int> all = components({"--keep", "all"});
  ASSERT_GT(all.size(), 1u);
  EXPECT_EQ(components({}), std::vector<int>{0});
  EXPECT_EQ(components({"--set", "geometries.rock.keep=ids:1"}), std::vector<int>{1});
  EXPECT_EQ(components({"--keep", "detached"}).size(), all.size() - 1);
}

// Far from the origin floats are too coarse for the error.
TEST_F(MeshCommandTest, FarFromTheOrigin) {
  const std::vector<std::string> far = {
      "--set",   "geometries.ball.field.density.center=[100000,0,0]",
      "--set",   "geometries.ball.bounds={\"min\":[99998.5,-1.5,-1.5],\"max\":[100001.5,1.5,1.5]}",
      "--error", "0.001"};
  for (const std::string& file : {ply_, glb_}) {
    std::vector<std::string> arguments = far;
    arguments.emplace_back("-o");
    arguments.push_back(file);
    const CommandResult result = mesh(ball_, arguments);
    ASSERT_EQ(result.code, 0) << result.err;
  }
  std::ifstream in(ply_, std::ios::binary);
  std::stringstream all;
  all << in.rdbuf();
  EXPECT_NE(all.str().find("property double x"), std::string::npos);
  const std::string obj = (folder_ / "out.obj").string();
  std::vector<std::string> arguments = far;
  arguments.insert(arguments.end(), {"-o", obj});
  ASSERT_EQ(mesh(ball_, arguments).code, 0);
  // The second coordinate about 0 has all digits of a double, the first about 100000 more than a
  // float's.
  std::istringstream first(read_text(obj).substr(read_text(obj).find("\nv ") + 3));
  std::string x;
  first >> x;
  EXPECT_NE(std::stod(x), double{std::stof(x)}) << x;
  std::ifstream glb(glb_, std::ios::binary);
  std::stringstream text;
  text << glb.rdbuf();
  EXPECT_NE(text.str().find("translation"), std::string::npos);
}

// Far away, only about its own middle is the ball fine enough for floats.
TEST_F(MeshCommandTest, RoundingOfPositionsIsWithinTheBound) {
  const CommandResult result =
      mesh(ball_, {"--set",
                   "geometries.ball.field.density={\"type\":\"sphere\",\"radius\":0.001,"
                   "\"center\":[1000.5,1000.5,1000.5],\"smoothing\":0.00001}",
                   "--set",
                   "geometries.ball.bounds={\"min\":[1000.4987,1000.4987,1000.4987],"
                   "\"max\":[1000.5013,1000.5013,1000.5013]}",
                   "--error", "3e-7", "-o", glb_, "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json info = json::parse(result.out);
  EXPECT_LE(info["error_bound"], 3e-7);
  // The node's translation in doubles, and positions about it.
  const std::string text = read_text(glb_);
  std::uint32_t length;
  std::memcpy(&length, text.data() + 12, 4);
  const json gltf = json::parse(text.substr(20, length));
  const json shift = gltf["nodes"][0]["translation"];
  const double radius = std::sqrt(1e-6 - 1e-10);
  const std::size_t vertices = info["vertices"];
  for (std::size_t i = 0; i < vertices; ++i) {
    float x[3];
    std::memcpy(x, text.data() + 28 + length + 12 * i, 12);
    double square = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_LT(std::abs(x[k]), 0.0011f);  // so rounding is 1e-10
      const double offset = double{x[k]} + (shift[k].get<double>() - 1000.5);
      square += offset * offset;
    }
    ASSERT_NEAR(std::sqrt(square), radius, info["error_bound"].get<double>());
  }
}

// Not even about its middle; a shallow octree keeps the mesh small.
TEST_F(MeshCommandTest, FloatsThatAreTooCoarseForGlbAreRefused) {
  const auto fine = [&](const std::string& file) {
    return mesh(ball_, {"--error", "1e-6", "--max-depth", "5", "-o", file});
  };
  const CommandResult refused = fine(glb_);
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("write .ply"), std::string::npos) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(glb_));
  EXPECT_EQ(fine(ply_).code, 0);
  EXPECT_NE(read_text(ply_).find("property double x"), std::string::npos);
}

TEST_F(MeshCommandTest, SaysWhatIsProvedOfTheLabels) {
  const CommandResult certified = mesh(ball_, {"--error", "0.1", "-o", ply_, "--json"});
  ASSERT_EQ(certified.code, 0) << certified.err;
  EXPECT_EQ(json::parse(certified.out)["labels_certified"], true);
  std::filesystem::remove(ply_);
  // A solid that fills its bounds: warned of as other commands do, and no mesh.
  const CommandResult filled =
      mesh(ball_, {"--error", "0.1", "-o", ply_, "--set",
                   "geometries.ball.bounds={\"min\":[-0.3,-0.3,-0.3],\"max\":[0.3,0.3,0.3]}"});
  EXPECT_EQ(filled.code, 1);
  EXPECT_NE(filled.err.find("reaches its bounds"), std::string::npos) << filled.err;
  EXPECT_NE(filled.err.find("would end"), std::string::npos) << filled.err;
  EXPECT_FALSE(std::filesystem::exists(ply_));
}

TEST_F(MeshCommandTest, WrongUsageNamesWhatIsWrong) {
  const auto fails = [&](const std::string& scene, std::vector<std::string> more, int code,
                         const std::string& part) {
    const CommandResult result = mesh(scene, more);
    EXPECT_EQ(result.code, code) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
    EXPECT_EQ(result.out, "");
  };
  fails(ball_, {"-o", ply_}, 2, "--error");
  fails(ball_, {"--error", "0", "-o", ply_}, 2, "--error");
  fails(ball_, {"--error", "0.01", "-o", "mesh.stl"}, 2, ".ply, .glb or .obj");
  fails(ball_, {"--error", "0.01", "-o", ply_, "--keep", "most"}, 2, "most");
  fails(ball_, {"--error", "0.01", "-o", ply_, "--geometry", "cube"}, 2, "ball");
  fails(ball_, {"--error", "0.01", "-o", "/nowhere/out.ply"}, 1, "/nowhere/out.ply");
  // A solid that its box cuts has no closed surface: the place is named and nothing is written.
  fails(ball_,
        {"--error", "0.01", "-o", ply_, "--set",
         "geometries.ball.bounds={\"min\":[-1.5,-1.5,-1.5],\"max\":[1.5,1.5,0.5]}"},
        1, "bounds");
  EXPECT_FALSE(std::filesystem::exists(ply_));
}

TEST_F(MeshCommandTest, MaxMemoryEndsItWithAMessageAndWithoutAFile) {
  folder_.write("out.ply", "old");
  // Of the labels that have to be made first, and of the mesh.
  const CommandResult labels = mesh(rock_, {"--error", "0.03", "-o", ply_, "--max-memory", "1e-5"});
  EXPECT_EQ(labels.code, 1);
  EXPECT_NE(labels.err.find("octree"), std::string::npos) << labels.err;
  const CommandResult result =
      mesh(ball_, {"--error", "0.00001", "-o", ply_, "--max-memory", "0.001"});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.err.find("the mesh has reached"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("1.02 MiB"), std::string::npos) << result.err;
  EXPECT_EQ(read_text(ply_), "old");
  EXPECT_EQ(mesh(ball_, {"--error", "0.01", "-o", ply_, "--max-memory", "1"}).code, 0);
  EXPECT_EQ(mesh(ball_, {"--error", "0.01", "-o", ply_, "--max-memory", "-1"}).code, 2);
}

TEST_F(MeshCommandTest, WhatIsNotMetIsReported) {
  const CommandResult result =
      mesh(ball_, {"--error", "0.00001", "--max-depth", "4", "-o", ply_, "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.err.find("depth limit"), std::string::npos) << result.err;
  const json info = json::parse(result.out);
  EXPECT_GT(info["unresolved_cells"], 0);
  EXPECT_FALSE(info["unresolved"].empty());
}

}  // namespace
}  // namespace morsel::test

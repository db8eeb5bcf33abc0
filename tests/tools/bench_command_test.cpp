// SPDX-License-Identifier: Apache-2.0
// What the benchmark says, not how fast it is.
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "command_scene.h"
#include "run_command.h"

namespace morsel::test {
namespace {

using nlohmann::json;

class BenchCommandTest : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  std::string rock_ = folder_.write("rock.json", kCommandScene).string();
};

TEST_F(BenchCommandTest, HasTheKeysThatOthersRelyOn) {
  const CommandResult result =
      run_morsel({"bench", rock_, "--error", "0.01", "--resolution", "64", "--repetitions", "1",
                  "--render-width", "32", "--render-spp", "2", "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json info = json::parse(result.out);  // one document and nothing else
  const json& v = info["vs_mesh"];
  for (const char* kind : {"primary", "incoherent", "shadow"}) {
    EXPECT_GT(v[kind], 0.0) << kind;
    EXPECT_GT(v["rays"][kind], 0) << kind;
  }
  EXPECT_GT(v["memory"], 0.0);
  EXPECT_GT(v["ready_time"], 0.0);
  EXPECT_GT(v["error"], 0.0);
  EXPECT_LE(v["mesh"]["error_bound"], v["error"]);
  // The two surfaces are the same: few rays graze so closely that they tell them apart.
  EXPECT_LT(v["differs"]["primary"]["one_hits"], 0.05);
  EXPECT_LT(v["differs"]["primary"]["far_apart"], 0.05);
  EXPECT_GT(v["hits"]["primary"], 0.05);
  EXPECT_EQ(v["rays"]["primary"], 64 * 64);
  // A camera ray a sample at least; and rays are some of the render, but not all.
  EXPECT_GE(info["renderer"]["rays"], 32 * 24 * 2);
  EXPECT_GT(info["renderer_efficiency"], 0.0);
  // A solver that evaluates nothing would not be one.
  for (const char* solver : {"sphere", "segment", "model"})
    ASSERT_TRUE(info["evaluations_per_ray"].contains(solver)) << solver;
  EXPECT_GT(info["evaluations_per_ray"]["sphere"], info["evaluations_per_ray"]["model"]);
  for (const auto& [solver, count] : info["evaluations_per_ray"].items())
    EXPECT_GT(count, 0.0) << solver;
}

TEST_F(BenchCommandTest, AMeshSceneHasItsRenderMeasured) {
  const std::string scene = folder_
                                .write("meshes.json",
                                       R"({"morsel": 1, "camera": {"position": [0, 1, 4]},
                     "render": {"resolution": [64, 48]},
                     "materials": [{"name": "m", "type": "diffuse"}],
                     "geometries": [{"name": "ball", "type": "sphere", "radius": 1}],
                     "instances": [{"name": "ball", "geometry": "ball", "material": "m"}],
                     "lights": [{"type": "environment"}]})")
                                .string();
  const CommandResult result = run_morsel({"bench", scene, "--repetitions", "1", "--render-width",
                                           "32", "--render-spp", "2", "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json info = json::parse(result.out);
  EXPECT_FALSE(info.contains("vs_mesh"));
  EXPECT_GE(info["renderer"]["rays"], 32 * 24 * 2);
  EXPECT_GT(info["renderer_efficiency"], 0.0);
  EXPECT_EQ(run_morsel({"bench", scene, "--geometry", "ball"}).code, 2);
}

TEST_F(BenchCommandTest, NothingToMeasureIsAnError) {
  const CommandResult result =
      run_morsel({"bench", rock_, "--set", "geometries.rock.keep=volume:1000"});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.err.find("nothing is kept"), std::string::npos) << result.err;
  EXPECT_EQ(run_morsel({"bench", rock_, "--error", "2"}).code, 2);
  EXPECT_EQ(run_morsel({"bench"}).code, 2);
}

// How often `part` is in `text`.
int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

TEST_F(BenchCommandTest, ThePageIsCompleteInItself) {
  const std::string page_file = (folder_ / "bench.html").string();
  const CommandResult result =
      run_morsel({"bench", rock_, "--error", "0.02", "--resolution", "32", "--repetitions", "1",
                  "--render-width", "16", "--render-spp", "1", "--scaling", "--layers", "2",
                  "--html", page_file, "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json info = json::parse(result.out);
  ASSERT_EQ(info["layers"].size(), 2u);
  EXPECT_EQ(info["layers"][1]["layers"], 2);
  EXPECT_GT(info["layers"][1]["components"], info["layers"][0]["components"]);
  EXPECT_GT(info["layers"][0]["evaluations_per_ray"], 0.0);
  ASSERT_FALSE(info["scaling"].empty());
  EXPECT_EQ(info["scaling"][0]["threads"], 1);
  EXPECT_EQ(info["scaling"][0]["speedup"], 1.0);

  const std::string page = read_text(page_file);
  EXPECT_EQ(page.rfind("<!DOCTYPE html>", 0), 0u);
  EXPECT_EQ(count_of(page, "<svg class=\"plot\""), 4);
  EXPECT_EQ(count_of(page, "<svg"), count_of(page, "</svg>"));
  EXPECT_EQ(count_of(page, "<rect"), 5);      // a bar for each ratio
  EXPECT_EQ(count_of(page, "<polyline"), 4);  // speed-up and ideal, labels, evaluations
  for (const char* bad : {"http://", "https://", "<script", "<link", "src=", "nan", "inf,"})
    EXPECT_EQ(page.find(bad), std::string::npos) << bad;
  // The bars say what the document says.
  char value[32];
  std::snprintf(value, sizeof value, ">%.3g</text>", info["vs_mesh"]["primary"].get<double>());
  EXPECT_NE(page.find(value), std::string::npos) << value;
}

}  // namespace
}  // namespace morsel::test

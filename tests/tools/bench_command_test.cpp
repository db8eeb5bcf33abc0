// SPDX-License-Identifier: Apache-2.0
// What the benchmark says, not how fast it is.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace morsel::test

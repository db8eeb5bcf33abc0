// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "command_scene.h"
#include "run_command.h"

namespace morsel::test {
namespace {

using nlohmann::json;

class RenderCommandTest : public ::testing::Test {
 protected:
  CommandResult render(const std::vector<std::string>& more = {},
                       const decltype(CommandOptions::then)& then = {}) {
    std::vector<std::string> arguments{"render", "scene.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    CommandOptions options;
    options.folder = folder_.path();
    options.then = then;
    return run_morsel(arguments, options);
  }

  bool exists(const char* name) const { return std::filesystem::exists(folder_ / name); }

  TemporaryFolder folder_;
  std::filesystem::path scene_ = folder_.write("scene.json", kCommandScene);
};

TEST_F(RenderCommandTest, WritesPictureAndPreviewAndNamesThem) {
  const CommandResult result = render();
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.out, "scene.exr\nscene.png\n");
  EXPECT_TRUE(exists("scene.exr"));
  EXPECT_TRUE(exists("scene.png"));
  EXPECT_EQ(folder_.count_files(), 4u);  // the scene, two pictures, the cache
  EXPECT_EQ(read_text(folder_ / "scene.exr").substr(0, 4), "\x76\x2f\x31\x01");
  EXPECT_EQ(read_text(folder_ / "scene.png").substr(1, 3), "PNG");
}

TEST_F(RenderCommandTest, NamesOfOutputsAreTheUsers) {
  ASSERT_EQ(render({"-o", "a.exr", "--no-png"}).code, 0);
  EXPECT_TRUE(exists("a.exr"));
  EXPECT_FALSE(exists("a.png"));
  ASSERT_EQ(render({"-o", "b.exr", "--png", "c.png", "--cache", "d.topo"}).code, 0);
  EXPECT_TRUE(exists("c.png"));
  EXPECT_TRUE(exists("d.topo"));
}

TEST_F(RenderCommandTest, StatisticsAreOneDocument) {
  const CommandResult result =
      render({"--stats", "json", "--spp", "3", "--crop", "4,5,20,15", "--threads", "2"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json statistics = json::parse(result.out);
  EXPECT_EQ(statistics["spp"], 3);
  EXPECT_EQ(statistics["window"], json({4, 5, 20, 15}));
  EXPECT_EQ(statistics["samples"]["total"], 16 * 10 * 3);
  EXPECT_EQ(statistics["samples"]["non_finite"], 0);
  EXPECT_EQ(statistics["rays"]["camera"], 16 * 10 * 3);
  EXPECT_EQ(statistics["hypertextures"][0]["geometry"], "rock");
  EXPECT_EQ(statistics["hypertextures"][0]["cache_built"], true);
  EXPECT_EQ(statistics["hypertextures"][0]["kept"], 1);

  ASSERT_EQ(render({"--stats", "json:stats.json", "--keep", "all"}).code, 0);
  const json file = json::parse(read_text(folder_ / "stats.json"));
  EXPECT_EQ(file["hypertextures"][0]["cache_built"], false);
  EXPECT_EQ(file["hypertextures"][0]["kept"], file["hypertextures"][0]["components"]);
  EXPECT_NE(render({"--stats", "text"}).out.find("samples"), std::string::npos);
}

TEST_F(RenderCommandTest, PixelsDependNeitherOnThreadsNorOnStreams) {
  ASSERT_EQ(render({"-o", "a.exr", "--threads", "1", "--quiet"}).code, 0);
  ASSERT_EQ(render({"-o", "b.exr", "--threads", "2", "--progress", "json"}).code, 0);
  EXPECT_EQ(read_text(folder_ / "a.png"), read_text(folder_ / "b.png"));
  ASSERT_EQ(render({"-o", "c.exr", "--seed", "5"}).code, 0);
  EXPECT_NE(read_text(folder_ / "a.png"), read_text(folder_ / "c.png"));
}

TEST_F(RenderCommandTest, CheckReportsEveryProblemAndRendersNothing) {
  EXPECT_EQ(render({"--check"}).out, "scene.json: valid\n");
  const CommandResult bad = render({"--check", "--spp", "0", "--keep", "most"});
  EXPECT_EQ(bad.code, 2);
  EXPECT_NE(bad.out.find("/render/spp"), std::string::npos) << bad.out;
  EXPECT_NE(bad.out.find("/geometries/0/keep"), std::string::npos) << bad.out;
  EXPECT_EQ(folder_.count_files(), 1u);

  const CommandResult command =
      run_morsel({"scene", "check", scene_.string(), "--set", "camera.fov=3", "--json"});
  EXPECT_EQ(command.code, 2);
  const json document = json::parse(command.out);
  EXPECT_EQ(document["valid"], false);
  EXPECT_EQ(document["problems"].size(), 1u);
}

TEST_F(RenderCommandTest, ImagesThatAreNoneAreFoundByTheCheck) {
  folder_.write("sky.exr", "not an image");
  const CommandResult result = render({"--check", "--set", "lights.0.file=sky.exr"});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.out.find("/lights/0/file"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("sky.exr"), std::string::npos) << result.out;
}

TEST_F(RenderCommandTest, OutputsThatCannotBeWrittenFailFirst) {
  const CommandResult result = render({"-o", "gone/a.exr"});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.err.find("gone/a.exr"), std::string::npos) << result.err;
  EXPECT_EQ(folder_.count_files(), 1u);
}

TEST_F(RenderCommandTest, CacheForSeveralHypertexturesIsRefused) {
  const CommandResult result = render(
      {"--cache", "a.topo", "--set",
       R"(geometries.floor={"name": "floor", "type": "hypertexture", "field": {"density": {"type": "sphere"}}})"});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find("geometries.NAME.cache"), std::string::npos) << result.err;
}

TEST_F(RenderCommandTest, InterruptExitsWith130AndLeavesNoPicture) {
  ASSERT_EQ(run_morsel({"cache", "build", scene_.string()}).code, 0);
  for (const int signal : {SIGINT, SIGTERM}) {
    // Hours of work; the signal comes when it has begun.
    const CommandResult result = render(
        {"--spp", "20000", "--resolution", "640x480", "-v"},
        [signal](int pid, const std::filesystem::path& err) {
          for (int i = 0; i < 600 && read_text(err).find("cache read") == std::string::npos; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
          std::this_thread::sleep_for(std::chrono::milliseconds(300));
          ::kill(pid, signal);
        });
    EXPECT_EQ(result.code, 130) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find("interrupted"), std::string::npos) << result.err;
    EXPECT_EQ(folder_.count_files(), 2u);
  }
}

}  // namespace
}  // namespace morsel::test

// SPDX-License-Identifier: Apache-2.0
// Renders in parts, as users run them: checkpoints, signals, shards.
#include "interrupted_render.h"

namespace morsel::test {
namespace {

TEST(ResumeCommand, KilledRendersGoOnToTheSamePixels) {
  InterruptedRender({"--spp", "64", "--resolution", "64x48"}).kill_and_resume(5, 1);
}

class RenderInParts : public ::testing::Test {
 protected:
  CommandResult morsel(const std::vector<std::string>& arguments,
                       const decltype(CommandOptions::then)& then = {}) {
    CommandOptions options;
    options.folder = folder_.path();
    options.then = then;
    return run_morsel(arguments, options);
  }
  bool exists(const char* name) const { return std::filesystem::exists(folder_ / name); }

  // Waits until rendering has begun: the program says so.
  static void wait_for(const std::filesystem::path& err, const char* words) {
    for (int i = 0; i < 1200 && read_text(err).find(words) == std::string::npos; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }

  TemporaryFolder folder_;
  std::filesystem::path scene_ = folder_.write("scene.json", kCommandScene);
};

TEST_F(RenderInParts, SignalsLeaveAPartialPictureAndACheckpoint) {
  ASSERT_EQ(morsel({"cache", "build", "scene.json"}).code, 0);
  const std::vector<std::string> render{
      "render", "scene.json",   "--spp",        "3000",       "--resolution",
      "64x48",  "--checkpoint", "a.checkpoint", "--progress", "plain"};
  for (const int signal : {SIGINT, SIGTERM}) {
    std::filesystem::remove(folder_ / "a.checkpoint");
    const CommandResult result =
        morsel(render, [signal](int pid, const std::filesystem::path& err) {
          wait_for(err, "rendering: ");
          ::kill(pid, signal);
        });
    EXPECT_EQ(result.code, 130) << result.err;
    EXPECT_EQ(result.out, "scene.exr\nscene.png\n");
    EXPECT_NE(result.err.find("interrupted"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("--resume"), std::string::npos) << result.err;
    EXPECT_TRUE(exists("scene.exr") && exists("scene.png") && exists("a.checkpoint"));
    EXPECT_EQ(folder_.count_files(), 6u);  // and the scene, its cache and its bricks
  }
  // Refused when the scene has changed, and the file is left as it was.
  const std::string before = read_text(folder_ / "a.checkpoint");
  std::vector<std::string> changed = render;
  changed.insert(changed.end(), {"--resume", "--set", "render.max_depth=1"});
  const CommandResult refused = morsel(changed);
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("/scene/render/max_depth was 2, is 1"), std::string::npos)
      << refused.err;
  EXPECT_EQ(read_text(folder_ / "a.checkpoint"), before);
}

TEST_F(RenderInParts, TheSecondSignalAborts) {
  const CommandResult result = morsel(
      {"render", "scene.json", "--spp", "100000", "--resolution", "640x480", "--progress", "plain"},
      [](int pid, const std::filesystem::path& err) {
        wait_for(err, "rendering: ");
        ::kill(pid, SIGTERM);
        ::kill(pid, SIGINT);
      });
  EXPECT_TRUE(result.code == 128 + SIGINT || result.code == 128 + SIGTERM) << result.code;
}

TEST_F(RenderInParts, APictureCanBeHadAtAnyTime) {
  const CommandResult result = morsel({"render", "scene.json", "--spp", "100000", "--resolution",
                                       "64x48", "--progress", "plain", "--preview", "live.png"},
                                      [&](int pid, const std::filesystem::path& err) {
                                        wait_for(err, "rendering: ");
                                        ::kill(pid, SIGUSR1);
                                        wait_for(err, "written as it is now");
                                        EXPECT_TRUE(exists("scene.exr"));
                                        EXPECT_TRUE(exists("live.png"));
                                        ::kill(pid, SIGINT);
                                      });
  EXPECT_EQ(result.code, 130) << result.err;
  EXPECT_NE(result.err.find("scene.exr: written as it is now"), std::string::npos) << result.err;
}

TEST_F(RenderInParts, MoreSamplesCanBeAddedLater) {
  ASSERT_EQ(morsel({"render", "scene.json", "--spp", "40", "-o", "whole.exr"}).code, 0);
  ASSERT_EQ(morsel({"render", "scene.json", "--spp", "9", "--checkpoint", "a.checkpoint"}).code, 0);
  ASSERT_EQ(morsel({"render", "scene.json", "--spp", "40", "--checkpoint", "a.checkpoint",
                    "--resume", "-o", "more.exr"})
                .code,
            0);
  EXPECT_TRUE(exr_pixels(folder_ / "whole.exr") == exr_pixels(folder_ / "more.exr"));
}

TEST_F(RenderInParts, ShardsMergeToTheSamePicture) {
  for (const char* target : {"0", "0.2"}) {
    const std::string set = std::string("render.noise_target=") + target;
    const std::vector<std::string> common{
        "render", "scene.json", "--spp", "10", "--set", set, "--set", "render.cryptomatte=true"};
    const auto with = [&](const std::vector<std::string>& more) {
      std::vector<std::string> all = common;
      all.insert(all.end(), more.begin(), more.end());
      return all;
    };
    ASSERT_EQ(morsel(with({"-o", "whole.exr"})).code, 0);
    std::vector<std::string> merge{"merge", "-o", "merged.exr"};
    for (const char* shard : {"0/3", "1/3", "2/3"}) {
      const std::string file = std::string("part_") + shard[0] + ".exr";
      ASSERT_EQ(morsel(with({"--shard", shard, "-o", file})).code, 0);
      merge.push_back(file);
    }
    const CommandResult merged = morsel(merge);
    ASSERT_EQ(merged.code, 0) << merged.err;
    EXPECT_EQ(merged.out, "merged.exr\nmerged.png\n");
    EXPECT_TRUE(exr_pixels(folder_ / "whole.exr") == exr_pixels(folder_ / "merged.exr"));
    EXPECT_EQ(read_text(folder_ / "whole.png"), read_text(folder_ / "merged.png"));
  }
  ASSERT_EQ(
      morsel({"render", "scene.json", "--spp", "10", "--shard", "1/3", "--set",
              "camera.vertical_fov=41", "--set", "render.cryptomatte=true", "-o", "other.exr"})
          .code,
      0);
  EXPECT_NE(morsel({"merge", "part_0.exr", "other.exr", "-o", "x.exr"}).err.find("another scene"),
            std::string::npos);
  const CommandResult twice = morsel({"merge", "part_0.exr", "./part_0.exr", "-o", "x.exr"});
  EXPECT_EQ(twice.code, 1);
  EXPECT_NE(twice.err.find("./part_0.exr: is given twice"), std::string::npos) << twice.err;
  std::filesystem::copy_file(folder_ / "part_0.exr", folder_ / "copy.exr");
  EXPECT_EQ(morsel({"merge", "part_0.exr", "copy.exr", "-o", "x.exr"}).code, 1);
  EXPECT_EQ(morsel({"merge", "whole.exr", "-o", "x.exr"}).code, 1);
  EXPECT_FALSE(exists("x.exr"));
  const CommandResult missing = morsel({"merge", "part_0.exr", "-o", "x.exr"});
  EXPECT_EQ(missing.code, 0);
  EXPECT_NE(missing.err.find("shard 1/3 is missing"), std::string::npos) << missing.err;
}

}  // namespace
}  // namespace morsel::test

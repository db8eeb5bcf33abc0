// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "command_scene.h"
#include "run_command.h"

namespace morsel::test {

// Renders of one scene that are killed and gone on with.
class InterruptedRender {
 public:
  // `more`: flags of every render.
  explicit InterruptedRender(std::vector<std::string> more) : more_(std::move(more)) {
    folder_.write("scene.json", kCommandScene);
    EXPECT_EQ(run_morsel({"cache", "build", (folder_ / "scene.json").string()}).code, 0);
    const auto start = std::chrono::steady_clock::now();
    const CommandResult whole = render({"-o", "whole.exr"});
    duration_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    EXPECT_EQ(whole.code, 0) << whole.err;
    whole_ = exr_pixels(folder_ / "whole.exr");
  }

  CommandResult render(const std::vector<std::string>& flags, double kill_after = 0.0,
                       int signal = SIGKILL) {
    std::vector<std::string> arguments{"render", "scene.json", "--no-png", "--progress", "none"};
    arguments.insert(arguments.end(), more_.begin(), more_.end());
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    CommandOptions options;
    options.folder = folder_.path();
    if (kill_after > 0.0)
      options.then = [=](int pid, const std::filesystem::path&) {
        std::this_thread::sleep_for(std::chrono::duration<double>(kill_after));
        ::kill(pid, signal);
      };
    return run_morsel(arguments, options);
  }

  // Killed at `kills` random moments; each time the checkpoint is absent or good, and going on from
  // it gives the pixels of a render in one go.
  void kill_and_resume(int kills, unsigned seed) {
    std::mt19937 random(seed);
    int checkpoints = 0;
    for (int i = 0; i < kills; ++i) {
      std::filesystem::remove(folder_ / "a.checkpoint");
      // Not before the program has begun, which takes a good part of so short a render.
      const double after = std::uniform_real_distribution<double>(0.2, 1.0)(random) * duration_;
      render({"-o", "a.exr", "--checkpoint", "a.checkpoint", "--checkpoint-interval", "0.03s"},
             after);
      const bool there = std::filesystem::exists(folder_ / "a.checkpoint");
      checkpoints += there;
      std::filesystem::remove(folder_ / "a.exr");
      const CommandResult result =
          render({"-o", "a.exr", "--checkpoint", "a.checkpoint", "--resume"});
      ASSERT_EQ(result.code, 0) << "killed after " << after << " s: " << result.err;
      EXPECT_NE(result.err.find(there ? "goes on after" : "no such checkpoint"), std::string::npos)
          << result.err;
      EXPECT_TRUE(exr_pixels(folder_ / "a.exr") == whole_) << "killed after " << after << " s";
    }
    // Else nothing was tested; half of the kills or more come after the first checkpoint.
    EXPECT_GT(checkpoints, 0);
  }

  const TemporaryFolder& folder() const { return folder_; }
  const std::string& whole() const { return whole_; }
  double duration() const { return duration_; }

 private:
  std::vector<std::string> more_;
  TemporaryFolder folder_;
  std::string whole_;
  double duration_ = 0.0;
};

}  // namespace morsel::test

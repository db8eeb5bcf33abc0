// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "command_scene.h"
#include "run_command.h"

namespace morsel::test {

// A folder with a scene of five pieces, and `morsel cache build` of it.
class CacheCommandTest : public ::testing::Test {
 protected:
  CommandResult build(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"cache", "build", scene_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_morsel(arguments);
  }

  TemporaryFolder folder_;
  std::string scene_ = folder_.write("scene.json", kCommandScene).string();
  std::string cache_ = (folder_ / "my.topo").string();
};

}  // namespace morsel::test

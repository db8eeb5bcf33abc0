// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "renderer/scene/load_scene.h"
#include "renderer/scene/scene_json.h"
#include "scene_files.h"
#include "tests/temporary_folder.h"

namespace morsel::render {

// The small scene in a folder of its own, loaded with what --set writes; what is warned of is kept.
class SceneLoaderTest : public ::testing::Test {
 protected:
  SceneLoaderTest() { folder_.write("triangle.obj", test::kTriangleObj); }

  std::filesystem::path small_scene() { return folder_.write("scene.json", test::kSmallScene); }

  LoadedScene load(const std::vector<std::string>& set = {}) {
    return load_scene(small_scene(), parse(set), options());
  }

  static std::vector<Override> parse(const std::vector<std::string>& set) {
    std::vector<Override> overrides;
    for (const std::string& text : set) overrides.push_back(parse_override(text));
    return overrides;
  }

  LoadOptions options() {
    LoadOptions options;
    options.warn = [this](const std::string& message) { warnings_.push_back(message); };
    return options;
  }

  test::TemporaryFolder folder_;
  std::vector<std::string> warnings_;
};

}  // namespace morsel::render

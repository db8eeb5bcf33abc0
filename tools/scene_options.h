// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <oneapi/tbb/global_control.h>
#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "renderer/scene/overrides.h"

namespace morsel::tools {

// SCENE and --set: what every command that reads a scene takes.
struct SceneOptions {
  std::string scene;
  std::vector<std::string> set;

  // Of --set. Throws params::InputError.
  std::vector<render::Override> overrides() const;
};
void add_scene_options(CLI::App& command, SceneOptions& options);
// Only --set.
void add_set_option(CLI::App& command, std::vector<std::string>& set);

// One override of `key` for each hypertexture geometry of the scene that `plain` yields, e.g. what
// `--keep all` means. `source` is how the user wrote it.
std::vector<render::Override> for_each_hypertexture(const std::string& scene,
                                                    const std::vector<render::Override>& plain,
                                                    const std::string& key,
                                                    const nlohmann::json& value,
                                                    const std::string& source);

// --max-memory: GiB that `what` says; 0 means no limit, and `gib` becomes default_max_memory().
void add_max_memory_option(CLI::App& command, double& gib, const std::string& what);
// 7/8 of the machine's memory, in GiB: beyond, the system would end programs without a message.
double default_max_memory();
std::uint64_t bytes_of(double gib);

// --threads: 0 means all that the process may use.
void add_threads_option(CLI::App& command, int& threads);
// While it lives, TBB uses at most `threads` threads. Null for 0.
std::unique_ptr<oneapi::tbb::global_control> limit_threads(int threads);

}  // namespace morsel::tools

// SPDX-License-Identifier: Apache-2.0
#include "tools/scene_options.h"

#include <fmt/format.h>
#include <unistd.h>

#include "renderer/scene/scene_json.h"
#include "tools/number_range.h"

namespace morsel::tools {

std::vector<render::Override> SceneOptions::overrides() const {
  std::vector<render::Override> parsed;
  for (const std::string& text : set) parsed.push_back(render::parse_override(text));
  return parsed;
}

void add_scene_options(CLI::App& command, SceneOptions& options) {
  command.add_option("SCENE", options.scene, "Scene file (JSON)")->required();
  add_set_option(command, options.set);
}

void add_set_option(CLI::App& command, std::vector<std::string>& set) {
  command
      .add_option("--set", set,
                  "Replace a value of the scene: path=value, e.g. geometries.rock.keep=all; "
                  "may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

std::vector<render::Override> for_each_hypertexture(const std::string& scene,
                                                    const std::vector<render::Override>& plain,
                                                    const std::string& key,
                                                    const nlohmann::json& value,
                                                    const std::string& source) {
  std::vector<render::Override> overrides;
  for (const render::GeometryEntry& entry :
       render::list_geometries(render::SceneDocument(scene, plain)))
    if (entry.type == "hypertexture")
      overrides.push_back({fmt::format("geometries.{}.{}", entry.index, key), value, source});
  return overrides;
}

void add_max_memory_option(CLI::App& command, double& gib, const std::string& what) {
  gib = default_max_memory();
  command
      .add_option("--max-memory", gib,
                  "GiB that " + what + "; 0: no limit; left out: 7/8 of the machine's memory")
      ->check(number_from(0.0, 1e6));
}

double default_max_memory() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), size = ::sysconf(_SC_PAGESIZE);
  if (pages <= 0 || size <= 0) return 0.0;
  return 0.875 * static_cast<double>(pages) * static_cast<double>(size) * 0x1p-30;
}

std::uint64_t bytes_of(double gib) { return static_cast<std::uint64_t>(gib * 0x1p30); }

void add_threads_option(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Number of threads; 0: one a processor")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
}

std::unique_ptr<oneapi::tbb::global_control> limit_threads(int threads) {
  if (threads == 0) return nullptr;
  return std::make_unique<oneapi::tbb::global_control>(
      oneapi::tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
}

}  // namespace morsel::tools

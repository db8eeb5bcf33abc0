// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "renderer/scene/scene_json.h"
#include "tools/commands.h"
#include "tools/count_engines.h"
#include "tools/reporter.h"
#include "tools/scene_options.h"
#include "topology/morse/region_growing.h"

namespace morsel::tools {
namespace {

struct Options {
  SceneOptions scene;
  ReportingOptions reporting;
  std::string geometry;
  EngineChoice choice{.resolutions = {64, 128, 256, 512, 1024}};
  bool json = false;
  int threads = 0;
};

void print_row(const nlohmann::json& row, const std::string& certified) {
  std::cout << fmt::format(
                   "{:<10} {:>10} {:>12} {:>10.2f}  {}\n", row["engine"].get<std::string>(),
                   row.contains("resolution") ? std::to_string(row["resolution"].get<int>()) : "",
                   row["components"].get<std::uint64_t>(), row["seconds"].get<double>(), certified)
            << std::flush;
}

int run(const Options& options, const Session& session) {
  const auto threads = limit_threads(options.threads);
  Reporter reporter(options.reporting);
  topology::Execution execution;
  execution.cancel = session.cancel;
  const render::SceneDocument document(options.scene.scene, options.scene.overrides());
  const geom::Hypertexture hypertexture = render::read_hypertexture(
      document, render::find_hypertexture(document, options.geometry), execution);
  if (options.json) {
    std::cout << count_by_engines(hypertexture, options.choice, execution, reporter).dump(2)
              << '\n';
    return kDone;
  }
  std::cout << fmt::format("{:<10} {:>10} {:>12} {:>10}  {}\n", "engine", "resolution",
                           "components", "seconds", "certified");
  count_by_engines(hypertexture, options.choice, execution, reporter, print_row);
  return kDone;
}

}  // namespace

void add_cache_compare(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand(
      "compare",
      "Count components by every method: certified, Morse, and region growing over voxels and over "
      "a polygonal mesh, which are not certified");
  add_scene_options(*command, options->scene);
  command->add_option("--geometry", options->geometry, "This hypertexture geometry");
  command
      ->add_option("--engine", options->choice.engines,
                   "Methods, separated by commas: certified, morse, voxel, mesh")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"certified", "morse", "voxel", "mesh"}))
      ->capture_default_str();
  command
      ->add_option("--resolution", options->choice.resolutions,
                   "Voxels along each side of the box, separated by commas, for voxel and mesh")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(2, topology::kMaxGridResolution))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print one JSON document");
  add_threads_option(*command, options->threads);
  add_reporting_options(*command, options->reporting);
  command->callback([options, &session] {
    session.run = [options, &session] { return run(*options, session); };
  });
}

}  // namespace morsel::tools

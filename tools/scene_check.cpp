// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "renderer/scene/load_scene.h"
#include "tools/commands.h"
#include "tools/image_check.h"
#include "tools/reporter.h"
#include "tools/scene_check.h"
#include "tools/scene_options.h"

namespace morsel::tools {

int print_problems(const std::string& scene, const std::vector<render::Override>& overrides,
                   Reporter& reporter, bool json) {
  render::LoadOptions load;
  load.check_image = check_image;
  load.warn = [&](const std::string& message) { reporter.warn(message); };
  const std::vector<std::string> problems = render::check_scene(scene, overrides, load);
  if (json) {
    const nlohmann::json result = {
        {"scene", scene}, {"valid", problems.empty()}, {"problems", problems}};
    std::cout << result.dump(2) << '\n';
  } else if (problems.empty()) {
    std::cout << scene << ": valid\n";
  } else {
    for (const std::string& problem : problems) std::cout << problem << '\n';
  }
  return problems.empty() ? kDone : kWrongUsage;
}

void add_scene_check(CLI::App& parent, Session& session) {
  struct Options {
    SceneOptions scene;
    ReportingOptions reporting;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand(
      "check", "Report everything that is wrong with a scene and the files it names");
  add_scene_options(*command, options->scene);
  command->add_flag("--json", options->json, "Print one JSON document");
  add_reporting_options(*command, options->reporting);
  command->callback([options, &session] {
    session.run = [options] {
      Reporter reporter(options->reporting);
      return print_problems(options->scene.scene, options->scene.overrides(), reporter,
                            options->json);
    };
  });
}

}  // namespace morsel::tools

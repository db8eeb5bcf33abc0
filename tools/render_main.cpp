// SPDX-License-Identifier: Apache-2.0
// `morsel-render`: the commands of `morsel` that need Embree and the image library.
#include "tools/commands.h"

int main(int argc, char** argv) {
  using namespace morsel::tools;
  return run_command_line(argc, argv, [](CLI::App& app, Session& session) {
    add_bench(app, session);
    add_merge(app, session);
    add_render(app, session);
    CLI::App* scene = app.add_subcommand("scene", "Scene files: check, new, schema");
    scene->require_subcommand(1);
    add_scene_check(*scene, session);
    add_scene_new(*scene, session);
    add_scene_schema(*scene, session);
  });
}

// SPDX-License-Identifier: Apache-2.0
// `morsel`: the commands that need neither Embree nor the image library. The others are in the
// executable `morsel-render`, which this one turns into when one of them is asked for: see README.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "tools/commands.h"
#include "tools/interrupt.h"
#include "tools/reporter.h"

namespace {

using namespace morsel::tools;

constexpr struct {
  const char* name;
  const char* help;
} kRendererCommands[] = {{"bench", "Measure rays against those of a mesh; topology"},
                         {"merge", "Join the shards of a render"},
                         {"render", "Render scenes"},
                         {"scene", "Scene files: check, new, schema"}};

// Beside this executable in a build tree, in its own folder when installed.
std::filesystem::path renderer_executable() {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path folder = self.parent_path();
  const std::filesystem::path beside = folder / "morsel-render";
  if (std::filesystem::exists(beside, error)) return beside;
  return folder / MORSEL_LIBEXEC_FROM_BIN / "morsel-render";
}

// Does not return unless the executable is not there.
int become_renderer(char** argv) {
  const std::filesystem::path program = renderer_executable();
  ::execv(program.c_str(), argv);
  say(fmt::format("morsel: error: {}: cannot run: {}\n", program.string(), std::strerror(errno)));
  return kFailed;
}

}  // namespace

int main(int argc, char** argv) {
  hold_interrupts();
  if (argc > 1)
    for (const auto& command : kRendererCommands)
      if (std::strcmp(argv[1], command.name) == 0) return become_renderer(argv);

  return run_command_line(argc, argv, [](CLI::App& app, Session& session) {
    for (const auto& command : kRendererCommands) app.add_subcommand(command.name, command.help);
    CLI::App* cache =
        app.add_subcommand("cache", "Topology caches: build, compare, export, info, verify");
    cache->require_subcommand(1);
    add_cache_build(*cache, session);
    add_cache_compare(*cache, session);
    add_cache_export(*cache, session);
    add_cache_info(*cache, session);
    add_cache_verify(*cache, session);
    CLI::App* field = app.add_subcommand("field", "Values of a field: eval, sample");
    field->require_subcommand(1);
    add_field_eval(*field, session);
    add_field_sample(*field, session);
    add_mesh(app, session);
  });
}

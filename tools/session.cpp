// SPDX-License-Identifier: Apache-2.0
#include "tools/session.h"
#include "tools/reporter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "hypertexture_geom/params/json_reader.h"
#include "hypertexture_geom/params/parameter.h"
#include "tools/interrupt.h"
#include "tools/man_options.h"
#include "tools/version.h"
#include "topology/certified.h"

namespace morsel::tools {
namespace {

int fail(const std::string& message, int code) {
  say(fmt::format("morsel: error: {}\n", message));
  return code;
}

// The parser says only that a command is missing. Empty when the first word is a command or a flag.
std::string unknown_command(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return {};
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  if (std::find(names.begin(), names.end(), argv[1]) != names.end()) return {};
  const std::string near = params::nearest_name(argv[1], names);
  return fmt::format("{}: unknown command{}; commands: {}", argv[1],
                     near.empty() ? "" : fmt::format(", did you mean \"{}\"?", near),
                     fmt::join(names, ", "));
}

int run_guarded(const Session& session) {
  try {
    const int code = session.run();
    std::cout.flush();
    if (!std::cout || std::fflush(stdout) != 0)
      return fail("cannot write to the standard output", kFailed);
    return code;
  } catch (const topology::Cancelled&) {
    return fail("interrupted", kInterrupted);
  } catch (const std::bad_alloc&) {
    return fail("out of memory", kFailed);
  } catch (const std::exception& e) {
    return fail(e.what(), exit_code_of(e));
  }
}

}  // namespace

int exit_code_of(const std::exception& error) {
  const bool wrong = dynamic_cast<const params::InputError*>(&error) != nullptr ||
                     dynamic_cast<const UsageError*>(&error) != nullptr;
  return wrong ? kWrongUsage : kFailed;
}

int run_command_line(int argc, char** argv, const std::function<void(CLI::App&, Session&)>& add) {
  CLI::App app("Hypertextured implicit surfaces without their debris: caches, fields, pictures",
               "morsel");
  app.set_version_flag("--version", version_text, "Print the versions of morsel and its libraries");
  // For make_man.sh.
  app.add_flag_callback("--man", [&app] { throw CLI::CallForVersion(man_options(app), 0); })
      ->group("");
  app.require_subcommand(1);
  Session session;
  session.cancel = &install_interrupt_handler();
  add(app, session);
  if (const std::string problem = unknown_command(app, argc, argv); !problem.empty())
    return fail(problem, kWrongUsage);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {  // --help, --version
    return app.exit(e, std::cout, std::cerr);
  } catch (const CLI::ParseError& e) {
    app.exit(e, std::cerr, std::cerr);
    return kWrongUsage;
  }
  return run_guarded(session);
}

}  // namespace morsel::tools

// SPDX-License-Identifier: Apache-2.0
#include "tools/session.h"
#include "tools/reporter.h"

#include <fmt/format.h>

#include <cstdio>
#include <iostream>
#include <string>

#include "hypertexture_geom/params/json_reader.h"
#include "tools/interrupt.h"
#include "tools/man_options.h"
#include "tools/usage_errors.h"
#include "tools/version.h"
#include "topology/certified.h"

namespace morsel::tools {
namespace {

int fail(const std::string& message, int code) {
  say(fmt::format("morsel: error: {}\n", message));
  return code;
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
  ignore_file_size_signal();
  add(app, session);
  tighten(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {  // --help, --version
    return app.exit(e, std::cout, std::cerr);
  } catch (const CLI::ParseError& e) {
    return fail(usage_error(app, e), kWrongUsage);
  }
  return run_guarded(session);
}

}  // namespace morsel::tools

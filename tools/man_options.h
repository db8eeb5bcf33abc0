// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace morsel::tools {

// The commands of `app` with all their options, as sections of a man page: what `--help` says, in
// roff. Commands without options of their own (which the other executable has) are left out.
std::string man_options(const CLI::App& app);

}  // namespace morsel::tools

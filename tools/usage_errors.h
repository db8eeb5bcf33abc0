// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace morsel::tools {

// A flag with one value that is given again takes the last: scripts append theirs to a command.
// Lists are left as they are. A flag without a value takes none (CLI11 takes numbers). For all
// flags that the commands below `app` have by now.
void tighten(CLI::App& app);

// What is wrong with a command line, once `app` failed to parse it: the command, the word, and what
// it may have been meant to be.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace morsel::tools

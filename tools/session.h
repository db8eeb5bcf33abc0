// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <atomic>
#include <functional>
#include <stdexcept>
#include <string>

namespace morsel::tools {

// Exit codes of every subcommand.
inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;
inline constexpr int kWrongUsage = 2;  // or an invalid scene
inline constexpr int kInterrupted = 130;

// A wrong command line that the parser could not know to be wrong; exits with kWrongUsage.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The exit code that an exception of a subcommand stands for.
int exit_code_of(const std::exception& error);

// What parsing the command line leaves behind.
struct Session {
  std::function<int()> run;           // of the subcommand that was named; returns the exit code
  const std::atomic<bool>* cancel{};  // becomes true at the first SIGINT or SIGTERM
};

// Parses and runs. `add` registers the subcommands: each adds itself to the app and sets
// Session::run in its callback. Prints errors on stderr and maps them to exit codes.
int run_command_line(int argc, char** argv, const std::function<void(CLI::App&, Session&)>& add);

}  // namespace morsel::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace morsel::test {

struct CommandResult {
  int code = -1;  // exit code, or 128 + signal
  std::string out, err;
};

struct CommandOptions {
  std::string input = {};             // for its standard input
  std::filesystem::path folder = {};  // to run in; empty: here
  std::filesystem::path output = {};  // instead of collecting its standard output
  std::uint64_t file_limit = 0;  // bytes that a file may have, as on a disk that is full; 0: any
  bool unprivileged = false;     // as nobody, if the tests run as root
  // Called once it runs, with the file that collects its standard error.
  std::function<void(int pid, const std::filesystem::path& err)> then = {};
};

// What an EXR file has after its header, in which times differ: the pixels.
std::string exr_pixels(const std::filesystem::path& file);

// Runs the `morsel` of this build with these arguments.
CommandResult run_morsel(const std::vector<std::string>& arguments,
                         const CommandOptions& options = {});

}  // namespace morsel::test

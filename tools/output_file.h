// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>

#include "topology/replacing_file.h"

namespace morsel::tools {

// A stream into a file that appears under its name only when it is complete (ReplacingFile).
class OutputFile {
 public:
  // Throws std::runtime_error that names the file when it cannot be made.
  explicit OutputFile(const std::filesystem::path& file);

  std::ofstream& stream() { return stream_; }
  // Throws std::runtime_error that names the file when not everything could be written.
  void commit();

 private:
  std::filesystem::path file_;
  topology::ReplacingFile replacing_;
  std::ofstream stream_;
};

}  // namespace morsel::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>

namespace morsel::tools {

// A file that appears under its name only when it is complete: bytes go to a temporary file beside
// it, commit() renames that. Without commit() nothing is left.
class OutputFile {
 public:
  // Throws std::runtime_error that names the file when it cannot be made.
  explicit OutputFile(const std::filesystem::path& file);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ofstream& stream() { return stream_; }
  // Throws std::runtime_error that names the file when not everything could be written.
  void commit();

 private:
  std::filesystem::path file_, temporary_;
  std::ofstream stream_;
};

// Throws std::runtime_error when no file can be made beside `file` or `file` is a folder: to be
// called before hours of work whose result goes there.
void require_writable(const std::filesystem::path& file);

}  // namespace morsel::tools

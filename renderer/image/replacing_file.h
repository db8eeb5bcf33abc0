// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace morsel::render {

// A file that appears under its name only when it is complete: write to temporary_path(), which is
// in the same directory and has the same extension, then commit(). Without commit() the
// destructor removes what was written.
class ReplacingFile {
 public:
  explicit ReplacingFile(std::filesystem::path path);
  ~ReplacingFile();
  ReplacingFile(const ReplacingFile&) = delete;
  ReplacingFile& operator=(const ReplacingFile&) = delete;

  const std::filesystem::path& temporary_path() const { return temporary_; }
  // Renames, replacing an existing file. Throws std::runtime_error that names the file.
  void commit();

 private:
  std::filesystem::path path_, temporary_;
  bool committed_ = false;
};

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>

namespace morsel::topology {

// Throws std::runtime_error that names `file` and the reason when no file can appear under that
// name: no such folder, no right to write there or no way to (a file is made there and removed at
// once, to see), a folder of that name, or something that is no regular file (a device, a pipe, a
// socket: renaming over one would destroy it). To be called before hours of work whose result goes
// there.
void require_replaceable(const std::filesystem::path& file);

// A program that is killed leaves its temporary file behind. The next write of the same name
// removes it if that process is gone and the file has not been written to for so long.
inline constexpr std::chrono::minutes kLeftoverAge{10};
// Does that at once, for whoever reads the file and may never write it again.
void remove_leftovers(const std::filesystem::path& file);

// A file that appears under its name only when it is complete: write to temporary_path(), which is
// in the same folder and has the same extension, then commit(). Without commit() the destructor
// removes what was written. A symbolic link is followed: what it points to is replaced.
class ReplacingFile {
 public:
  // Checks as require_replaceable does, but makes no file yet.
  explicit ReplacingFile(const std::filesystem::path& file);
  ~ReplacingFile();
  ReplacingFile(const ReplacingFile&) = delete;
  ReplacingFile& operator=(const ReplacingFile&) = delete;

  const std::filesystem::path& temporary_path() const { return temporary_; }
  // Waits until the bytes are on the disk, then renames, replacing an existing file: whatever
  // happens to the machine, the name stands for the old file or the whole new one. Throws
  // std::runtime_error that names the file.
  void commit();

 private:
  std::filesystem::path named_, target_, temporary_;
  bool committed_ = false;
};

}  // namespace morsel::topology

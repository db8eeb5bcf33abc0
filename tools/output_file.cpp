// SPDX-License-Identifier: Apache-2.0
#include "tools/output_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace morsel::tools {

namespace fs = std::filesystem;

OutputFile::OutputFile(const fs::path& file) : file_(file) {
  require_writable(file);
  temporary_ = file.parent_path() /
               fmt::format(".{}.{}.tmp", file.filename().string(), static_cast<long>(::getpid()));
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!stream_)
    throw std::runtime_error(
        fmt::format("{}: cannot write: {}", file.string(), std::strerror(errno)));
}

OutputFile::~OutputFile() {
  if (temporary_.empty()) return;
  stream_.close();
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void OutputFile::commit() {
  stream_.close();
  if (!stream_)
    throw std::runtime_error(
        fmt::format("{}: cannot write: {}", file_.string(), std::strerror(errno)));
  fs::rename(temporary_, file_);
  temporary_.clear();
}

void require_writable(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(folder, error))
    throw std::runtime_error(
        fmt::format("{}: cannot write: no folder {}", file.string(), folder.string()));
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    throw std::runtime_error(
        fmt::format("{}: cannot write: {}", file.string(), std::strerror(errno)));
  if (file.filename().empty() || fs::is_directory(file, error))
    throw std::runtime_error(fmt::format("{}: cannot write: is a folder", file.string()));
}

}  // namespace morsel::tools

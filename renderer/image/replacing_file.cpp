// SPDX-License-Identifier: Apache-2.0
#include "renderer/image/replacing_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <stdexcept>
#include <system_error>

namespace morsel::render {

ReplacingFile::ReplacingFile(std::filesystem::path path) : path_(std::move(path)) {
  static std::atomic<unsigned> serial{0};
  temporary_ = path_;
  temporary_.replace_filename(fmt::format(".{}.{}.{}{}", path_.stem().string(), ::getpid(),
                                          serial++, path_.extension().string()));
}

ReplacingFile::~ReplacingFile() {
  std::error_code ignored;
  if (!committed_) std::filesystem::remove(temporary_, ignored);
}

void ReplacingFile::commit() {
  std::error_code error;
  std::filesystem::rename(temporary_, path_, error);
  if (error)
    throw std::runtime_error(fmt::format("{}: cannot write: {}", path_.string(), error.message()));
  committed_ = true;
}

}  // namespace morsel::render

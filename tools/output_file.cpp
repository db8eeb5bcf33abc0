// SPDX-License-Identifier: Apache-2.0
#include "tools/output_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace morsel::tools {
namespace {

void check(const std::ofstream& stream, const std::filesystem::path& file) {
  if (!stream)
    throw std::runtime_error(
        fmt::format("{}: cannot write: {}", file.string(), std::strerror(errno)));
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& file)
    : file_(file),
      replacing_(file),
      stream_(replacing_.temporary_path(), std::ios::binary | std::ios::trunc) {
  check(stream_, file_);
}

void OutputFile::commit() {
  stream_.close();
  check(stream_, file_);
  replacing_.commit();
}

}  // namespace morsel::tools

// SPDX-License-Identifier: Apache-2.0
#include "topology/replacing_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

namespace morsel::topology {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& file, const std::string& why) {
  throw std::runtime_error(fmt::format("{}: cannot write: {}", file.string(), why));
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

// Where the bytes go: `file`, or what it links to.
fs::path followed(const fs::path& file) {
  std::error_code error;
  if (!fs::is_symlink(file, error)) return file;
  const fs::path target = fs::weakly_canonical(file, error);
  return error ? file : target;
}

// False when the system can't or won't; some file systems have no such operation for folders.
bool synchronise(const fs::path& path, int flags) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC);
  if (fd < 0) return false;
  const bool done = ::fsync(fd) == 0;
  const int kept = errno;
  ::close(fd);
  errno = kept;
  return done;
}

// The name before a process' number and the one after it, in those of temporary files.
struct TemporaryName {
  std::string before, after;
  explicit TemporaryName(const fs::path& target)
      : before(fmt::format(".{}.", target.stem().string())), after(target.extension().string()) {}
  std::string of(pid_t process, unsigned serial) const {
    return fmt::format("{}{}.{}{}", before, process, serial, after);
  }
  // The process that a file of this name belongs to; 0: it is none of these.
  pid_t process_of(std::string_view name) const {
    if (name.size() < before.size() + after.size() || !name.starts_with(before) ||
        !name.ends_with(after))
      return 0;
    name.remove_prefix(before.size());
    name.remove_suffix(after.size());
    const char* const end = name.data() + name.size();
    pid_t process = 0;
    unsigned serial = 0;
    const auto [dot, bad_process] = std::from_chars(name.data(), end, process);
    if (bad_process != std::errc() || process <= 0 || dot == end || *dot != '.') return 0;
    const auto [last, bad_serial] = std::from_chars(dot + 1, end, serial);
    return bad_serial == std::errc() && last == end ? process : 0;
  }
};

// A name beside `target` that no other file of this process has.
fs::path name_beside(const fs::path& target) {
  static std::atomic<unsigned> serial{0};
  fs::path name = target;
  name.replace_filename(TemporaryName(target).of(::getpid(), serial++));
  return name;
}

// All that can be seen without writing.
void check_place(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (file.filename().empty() || fs::is_directory(status)) fail(file, "is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status))
    fail(file, "is no regular file but a device, pipe or socket");
  const fs::path folder = folder_of(followed(file));
  if (!fs::is_directory(folder, error)) fail(file, "no folder " + folder.string());
  if (::access(folder.c_str(), W_OK | X_OK) != 0) fail(file, std::strerror(errno));
}

}  // namespace

void remove_leftovers(const fs::path& target) {
  const TemporaryName names(target);
  std::error_code error;
  // Whoever writes still must not lose its file: the process must be gone and, since it may be one
  // of another machine or container, whose numbers say nothing here, the file must have rested.
  for (fs::directory_iterator entry(folder_of(target), error), end; !error && entry != end;
       entry.increment(error)) {
    const pid_t process = names.process_of(entry->path().filename().native());
    if (process == 0 || ::kill(process, 0) == 0 || errno != ESRCH) continue;
    std::error_code ignored;
    if (!entry->is_regular_file(ignored)) continue;
    const auto written = entry->last_write_time(ignored);
    if (ignored || fs::file_time_type::clock::now() - written < kLeftoverAge) continue;
    fs::remove(entry->path(), ignored);
  }
}

void require_replaceable(const fs::path& file) {
  check_place(file);
  // Rights are not all: /proc takes no files, not even root's, and a name may be too long.
  const fs::path probe = name_beside(followed(file));
  const int fd = ::open(probe.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (fd < 0) fail(file, std::strerror(errno));
  ::close(fd);
  ::unlink(probe.c_str());
}

ReplacingFile::ReplacingFile(const fs::path& file) : named_(file) {
  check_place(file);
  target_ = followed(file);
  remove_leftovers(target_);
  temporary_ = name_beside(target_);
}

ReplacingFile::~ReplacingFile() {
  std::error_code ignored;
  if (!committed_) fs::remove(temporary_, ignored);
}

void ReplacingFile::commit() {
  if (!synchronise(temporary_, O_WRONLY)) fail(named_, std::strerror(errno));
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) fail(named_, error.message());
  committed_ = true;
  synchronise(folder_of(target_), O_RDONLY | O_DIRECTORY);
}

}  // namespace morsel::topology

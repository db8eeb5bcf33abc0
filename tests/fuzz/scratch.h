// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <span>
#include <string>
#include <thread>

namespace morsel::test {

// A folder for the files of a process' inputs, in memory where that is possible; it goes at exit.
inline const std::filesystem::path& scratch_folder() {
  struct Folder {
    std::filesystem::path path;
    Folder() {
      const std::filesystem::path memory = "/dev/shm";
      path = (std::filesystem::is_directory(memory) ? memory
                                                    : std::filesystem::temp_directory_path()) /
             ("morsel_fuzz_" + std::to_string(::getpid()));
      std::filesystem::create_directories(path);
    }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
  };
  static const Folder folder;
  return folder.path;
}

inline std::filesystem::path write_file(const std::filesystem::path& path,
                                        std::span<const std::byte> bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  return path;
}
inline std::filesystem::path write_file(const std::filesystem::path& path,
                                        const std::string& text) {
  return write_file(path, std::as_bytes(std::span(text)));
}

// The input, taken from the front; what is not there is zero.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(std::as_bytes(std::span(data, size))) {}

  bool empty() const { return rest_.empty(); }
  std::span<const std::byte> rest() const { return rest_; }
  std::span<const std::byte> take(std::size_t count) {
    const auto part = rest_.first(std::min(rest_.size(), count));
    rest_ = rest_.subspan(part.size());
    return part;
  }
  std::uint32_t byte() {
    const auto part = take(1);
    return part.empty() ? 0u : std::to_integer<std::uint32_t>(part[0]);
  }
  std::uint32_t word() {  // 16 bits
    const std::uint32_t low = byte();
    return low | byte() << 8;
  }

 private:
  std::span<const std::byte> rest_;
};

// Sets stop() after a time: inputs may ask for more work than anyone wants to wait for.
class Deadline {
 public:
  explicit Deadline(std::chrono::milliseconds time)
      : thread_([this, time] {
          std::unique_lock lock(mutex_);
          if (!ended_.wait_for(lock, time, [&] { return over_; })) stop_ = true;
        }) {}
  ~Deadline() {
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
    }
    ended_.notify_one();
    thread_.join();
  }
  const std::atomic<bool>& stop() const { return stop_; }

 private:
  std::atomic<bool> stop_{false};
  bool over_ = false;
  std::mutex mutex_;
  std::condition_variable ended_;
  std::thread thread_;
};

}  // namespace morsel::test

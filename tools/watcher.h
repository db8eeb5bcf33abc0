// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace morsel::tools {

// Does things from time to time, on a thread of its own, while something else goes on.
class Watcher {
 public:
  using Clock = std::chrono::steady_clock;
  // Returns when it wants to be called next.
  using Task = std::function<Clock::time_point(Clock::time_point now)>;

  Watcher() = default;
  ~Watcher() { stop(); }
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;

  // Before start(). Tasks must not throw.
  void add(Clock::time_point first, Task task) { entries_.push_back({first, std::move(task)}); }
  void start();
  // Waits for a task in work. No task is called after that.
  void stop();

 private:
  struct Entry {
    Clock::time_point due;
    Task task;
  };
  void run();

  std::vector<Entry> entries_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::thread thread_;
};

// Between a clock's durations and seconds.
inline Watcher::Clock::duration to_duration(double seconds) {
  return std::chrono::duration_cast<Watcher::Clock::duration>(
      std::chrono::duration<double>(seconds));
}
inline double seconds_since(Watcher::Clock::time_point start) {
  return std::chrono::duration<double>(Watcher::Clock::now() - start).count();
}

}  // namespace morsel::tools

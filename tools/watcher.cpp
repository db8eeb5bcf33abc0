// SPDX-License-Identifier: Apache-2.0
#include "tools/watcher.h"

#include <algorithm>

namespace morsel::tools {

void Watcher::start() {
  if (!entries_.empty()) thread_ = std::thread([this] { run(); });
}

void Watcher::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Watcher::run() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    const auto next =
        std::min_element(entries_.begin(), entries_.end(),
                         [](const Entry& a, const Entry& b) { return a.due < b.due; });
    if (Clock::now() < next->due) {
      wake_.wait_until(lock, next->due);
      continue;
    }
    lock.unlock();
    next->due = next->task(Clock::now());
    lock.lock();
  }
}

}  // namespace morsel::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace morsel::render {

// A sample whose radiance was NaN or infinite.
struct NonFinitePlace {
  int y = 0, x = 0;          // pixel of the full image
  std::uint32_t half = 0;    // of adaptive sampling, 0 without
  std::uint32_t sample = 0;  // in the half's sequence
  std::uint32_t bounce = 0;  // bounces of the path before it
  // NOLINTNEXTLINE(modernize-use-nullptr): there is no pointer.
  auto operator<=>(const NonFinitePlace&) const = default;

  // "pixel 12,7, sample 3, after bounce 1"
  std::string text() const;
};

// Where a render met such samples: the first few in the order of the picture, which depends
// neither on threads nor on passes. Thread-safe.
class NonFiniteReport {
 public:
  static constexpr std::size_t kMost = 8;

  // With `stop`, the first that any thread meets throws std::runtime_error with its place.
  explicit NonFiniteReport(bool stop) : stop_(stop) {}

  void add(const NonFinitePlace& place);
  std::vector<NonFinitePlace> places() const;

 private:
  bool stop_;
  mutable std::mutex mutex_;
  std::set<NonFinitePlace> places_;
};

}  // namespace morsel::render

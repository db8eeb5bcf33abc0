// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "topology/morse/critical_point.h"

namespace morsel::topology {

// Finds the maximum whose certified basin holds a point, by a kd-tree of the maxima.
class MaximumFinder {
 public:
  // Copies what it needs of the maxima among `points`; indices are into `points`.
  explicit MaximumFinder(std::span<const CriticalPoint> points);
  ~MaximumFinder();
  MaximumFinder(MaximumFinder&&) noexcept;
  MaximumFinder& operator=(MaximumFinder&&) noexcept;

  // Index of the maximum in whose basin `x` lies; basins of two maxima don't meet.
  std::optional<std::uint32_t> basin_of(const Imath::V3d& x) const;

  // Index of the nearest maximum, as a hint in messages only: the nearest need not be the one that
  // an ascent ends at. Empty when there is none.
  std::optional<std::uint32_t> nearest(const Imath::V3d& x) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace morsel::topology

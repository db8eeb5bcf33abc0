// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/math/huge_pages.h"

namespace morsel::render {

// Distributions over n cells each, which choose one with probability proportional to its weight, by
// inversion of the cumulative sums: that keeps the stratification of the random numbers. All of
// them lie in one piece of memory.
class DistributionRows {
 public:
  // Of every row set() must be called before it is sampled. Throws std::invalid_argument for no
  // cell.
  DistributionRows(std::size_t rows, std::size_t cells);

  // Weights are finite and >= 0; when all are zero every cell gets the same probability. Throws
  // std::invalid_argument for a negative or non-finite weight, or a wrong number of them.
  void set(std::size_t row, std::span<const double> weights);

  struct Cell {
    std::size_t index;
    float offset;       // where in the cell `u` fell, [0, 1): can be used again
    float probability;  // > 0
  };
  Cell sample(std::size_t row, float u) const {  // u in [0, 1)
    const float* cumulative = &cumulative_[row * (cells_ + 1)];
    const auto bucket = static_cast<std::size_t>(u * static_cast<float>(guides_));
    std::size_t index = guide_[row * guides_ + std::min(bucket, guides_ - 1)];
    // The product may have been rounded up into the next bucket.
    while (cumulative[index] > u) --index;
    while (cumulative[index + 1] <= u) ++index;
    const float width = cumulative[index + 1] - cumulative[index];
    return {index, std::min((u - cumulative[index]) / width, 0x1.fffffep-1f), width};
  }

  // Exactly the probability that sample() chooses the cell with; may be 0 for tiny weights.
  float probability(std::size_t row, std::size_t index) const {
    const float* cumulative = &cumulative_[row * (cells_ + 1)];
    return cumulative[index + 1] - cumulative[index];
  }
  std::size_t cells() const { return cells_; }

 private:
  std::size_t cells_, guides_;
  std::vector<float, HugePageAllocator<float>> cumulative_;  // of each row cells + 1, from 0 to 1
  // The cell that u = i / guides_ falls into: where to start looking, so that looking takes a few
  // steps on end instead of a binary search ("guide table", Chen & Asau 1974).
  std::vector<std::uint32_t> guide_;
};

// One of them. Throws as they do.
class Distribution1D {
 public:
  using Cell = DistributionRows::Cell;

  explicit Distribution1D(std::span<const double> weights) : row_(1, weights.size()) {
    row_.set(0, weights);
  }
  Cell sample(float u) const { return row_.sample(0, u); }
  float probability(std::size_t index) const { return row_.probability(0, index); }
  std::size_t size() const { return row_.cells(); }

 private:
  DistributionRows row_;
};

}  // namespace morsel::render

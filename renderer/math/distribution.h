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
    const Word* const words = &words_[row * stride()];
    std::size_t index = start(words, u);
    const Word* const cumulative = words + guides_;
    // The product may have been rounded up into the next bucket.
    while (cumulative[index].sum > u) --index;
    while (cumulative[index + 1].sum <= u) ++index;
    const float lower = cumulative[index].sum, width = cumulative[index + 1].sum - lower;
    return {index, std::min((u - lower) / width, 0x1.fffffep-1f), width};
  }

  // That it will be sampled soon, so that what this needs of memory is fetched meanwhile.
  void prefetch(std::size_t row, float u) const {
    const Word* const words = &words_[row * stride()];
    __builtin_prefetch(words + guides_ + start(words, u));
  }

  // Exactly the probability that sample() chooses the cell with; may be 0 for tiny weights.
  float probability(std::size_t row, std::size_t index) const {
    const Word* const cumulative = &words_[row * stride() + guides_];
    return cumulative[index + 1].sum - cumulative[index].sum;
  }
  std::size_t cells() const { return cells_; }

 private:
  // A bucket's cells are half a cache line, so that the walk costs less than the guide's own line
  // would: the guides of a large environment should stay in the processor's cache.
  static constexpr std::size_t kCellsPerBucket = 8;
  // A row is its guide and its cells + 1 sums, from 0 to 1, side by side in one page of memory: to
  // find a page takes longer than to read from it. The guide has the cell that u = i / guides_
  // falls into: where to start looking, so that looking takes a few steps on end instead of a
  // binary search ("guide table", Chen & Asau 1974).
  union Word {
    std::uint32_t cell;
    float sum;
  };
  std::size_t stride() const { return guides_ + cells_ + 1; }
  std::size_t start(const Word* guide, float u) const {
    const auto bucket = static_cast<std::uint32_t>(u * static_cast<float>(guides_));
    return guide[std::min(bucket, guides_ - 1)].cell;
  }

  std::size_t cells_;
  std::uint32_t guides_;
  std::vector<Word, HugePageAllocator<Word>> words_;
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

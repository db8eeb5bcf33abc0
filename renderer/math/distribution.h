// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace morsel::render {

// Chooses one of n cells with probability proportional to its weight, by inversion of the
// cumulative sums, which keeps the stratification of the random numbers.
class Distribution1D {
 public:
  // Weights are finite and >= 0; when all are zero every cell gets the same probability. Throws
  // std::invalid_argument for no cell, or a negative or non-finite weight.
  explicit Distribution1D(std::span<const double> weights);

  struct Cell {
    std::size_t index;
    float offset;       // where in the cell `u` fell, [0, 1): can be used again
    float probability;  // > 0
  };
  Cell sample(float u) const;  // u in [0, 1)

  // Exactly the probability that sample() chooses the cell with; may be 0 for tiny weights.
  float probability(std::size_t index) const { return cumulative_[index + 1] - cumulative_[index]; }
  std::size_t size() const { return cumulative_.size() - 1; }

 private:
  std::vector<float> cumulative_;  // size() + 1 values from 0 to 1
  // The cell that u = i / guide_.size() falls into: where to start looking, so that looking takes a
  // few steps on end instead of a binary search ("guide table", Chen & Asau 1974).
  std::vector<std::uint32_t> guide_;
};

}  // namespace morsel::render

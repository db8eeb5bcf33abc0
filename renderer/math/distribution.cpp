// SPDX-License-Identifier: Apache-2.0
#include "renderer/math/distribution.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "renderer/math/vector.h"

namespace morsel::render {
namespace {

// A bucket's cells are half a cache line, so that the walk costs less than the guide's own line
// would: the guides of a large environment should stay in the processor's cache.
constexpr std::size_t kCellsPerBucket = 8;

}  // namespace

DistributionRows::DistributionRows(std::size_t rows, std::size_t cells)
    : cells_(cells),
      guides_((cells + kCellsPerBucket - 1) / kCellsPerBucket),
      cumulative_(rows * (cells + 1)),
      guide_(rows * guides_) {
  if (cells == 0) throw std::invalid_argument("a distribution needs at least one weight");
}

void DistributionRows::set(std::size_t row, std::span<const double> weights) {
  if (weights.size() != cells_)
    throw std::invalid_argument("a distribution needs one weight for each cell");
  double total = 0.0;
  for (const double w : weights) {
    if (!(w >= 0.0) || !std::isfinite(w))
      throw std::invalid_argument("a distribution's weights must be finite and >= 0");
    total += w;
  }
  float* cumulative = &cumulative_[row * (cells_ + 1)];
  double sum = 0.0;
  cumulative[0] = 0.0f;
  for (std::size_t i = 0; i < cells_; ++i) {
    sum += total > 0.0 ? weights[i] / total : 1.0 / static_cast<double>(cells_);
    cumulative[i + 1] = std::min(1.0f, static_cast<float>(sum));
  }
  // Rounding must not leave a gap below 1 that belongs to a cell without weight.
  const float last = cumulative[cells_];
  for (std::size_t i = cells_; i > 0 && cumulative[i] == last; --i) cumulative[i] = 1.0f;

  std::uint32_t cell = 0;
  for (std::size_t i = 0; i < guides_; ++i) {
    const float u = static_cast<float>(i) / static_cast<float>(guides_);
    while (cumulative[cell + 1] <= u) ++cell;
    guide_[row * guides_ + i] = cell;
  }
}

}  // namespace morsel::render

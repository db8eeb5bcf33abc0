// SPDX-License-Identifier: Apache-2.0
#include "renderer/math/distribution.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "renderer/math/vector.h"

namespace morsel::render {

DistributionRows::DistributionRows(std::size_t rows, std::size_t cells)
    : cells_(cells),
      guides_(static_cast<std::uint32_t>((cells + kCellsPerBucket - 1) / kCellsPerBucket)),
      words_(rows * stride()) {
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
  Word* const words = &words_[row * stride()];
  Word* const cumulative = words + guides_;
  double sum = 0.0;
  cumulative[0].sum = 0.0f;
  for (std::size_t i = 0; i < cells_; ++i) {
    sum += total > 0.0 ? weights[i] / total : 1.0 / static_cast<double>(cells_);
    cumulative[i + 1].sum = std::min(1.0f, static_cast<float>(sum));
  }
  // Rounding must not leave a gap below 1 that belongs to a cell without weight.
  const float last = cumulative[cells_].sum;
  for (std::size_t i = cells_; i > 0 && cumulative[i].sum == last; --i) cumulative[i].sum = 1.0f;

  std::uint32_t cell = 0;
  for (std::size_t i = 0; i < guides_; ++i) {
    const float u = static_cast<float>(i) / static_cast<float>(guides_);
    while (cumulative[cell + 1].sum <= u) ++cell;
    words[i].cell = cell;
  }
}

}  // namespace morsel::render

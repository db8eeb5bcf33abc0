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

Distribution1D::Distribution1D(std::span<const double> weights) {
  if (weights.empty()) throw std::invalid_argument("a distribution needs at least one weight");
  double total = 0.0;
  for (const double w : weights) {
    if (!(w >= 0.0) || !std::isfinite(w))
      throw std::invalid_argument("a distribution's weights must be finite and >= 0");
    total += w;
  }
  cumulative_.resize(weights.size() + 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += total > 0.0 ? weights[i] / total : 1.0 / static_cast<double>(weights.size());
    cumulative_[i + 1] = std::min(1.0f, static_cast<float>(sum));
  }
  // Rounding must not leave a gap below 1 that belongs to a cell without weight.
  const float last = cumulative_.back();
  for (std::size_t i = weights.size(); i > 0 && cumulative_[i] == last; --i) cumulative_[i] = 1.0f;

  guide_.resize((weights.size() + kCellsPerBucket - 1) / kCellsPerBucket);
  std::uint32_t cell = 0;
  for (std::size_t i = 0; i < guide_.size(); ++i) {
    const float u = static_cast<float>(i) / static_cast<float>(guide_.size());
    while (cumulative_[cell + 1] <= u) ++cell;
    guide_[i] = cell;
  }
}

Distribution1D::Cell Distribution1D::sample(float u) const {
  const auto bucket = static_cast<std::size_t>(u * static_cast<float>(guide_.size()));
  std::size_t index = guide_[std::min(bucket, guide_.size() - 1)];
  // The product may have been rounded up into the next bucket.
  while (cumulative_[index] > u) --index;
  while (cumulative_[index + 1] <= u) ++index;
  const float width = probability(index);
  const float offset = std::min((u - cumulative_[index]) / width, kOneMinusEpsilon);
  return {index, offset, width};
}

}  // namespace morsel::render

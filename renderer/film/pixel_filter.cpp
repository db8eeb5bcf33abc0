// SPDX-License-Identifier: Apache-2.0
#include "renderer/film/pixel_filter.h"

#include <fmt/format.h>

#include <stdexcept>
#include <vector>

namespace morsel::render {
namespace {

// At x in [-1, 1], in units of the radius.
double weight(PixelFilter filter, double x) {
  constexpr double kTurn = 3.14159265358979323846;
  switch (filter) {
    case PixelFilter::kBox:
      return 1.0;
    case PixelFilter::kTriangle:
      return 1.0 - std::abs(x);
    case PixelFilter::kGaussian:  // falls to nothing at the radius, three standard deviations
      return std::exp(-4.5 * x * x) - std::exp(-4.5);
    case PixelFilter::kBlackmanHarris: {
      const double t = kTurn * (x + 1.0);
      return 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2.0 * t) -
             0.01168 * std::cos(3.0 * t);
    }
  }
  return 0.0;
}

}  // namespace

FilterSampler::FilterSampler(PixelFilter filter, float radius) : filter_(filter), radius_(radius) {
  if (!(radius > 0.0f && radius <= 16.0f))
    throw std::invalid_argument(
        fmt::format("pixel filter: a radius of {} pixels; valid are 0 < radius <= 16", radius));
  constexpr int kFine = 4096;
  std::vector<double> cumulative(kFine + 1, 0.0);
  for (int i = 0; i < kFine; ++i)
    cumulative[static_cast<std::size_t>(i) + 1] =
        cumulative[static_cast<std::size_t>(i)] +
        std::max(0.0, weight(filter, 2.0 * (i + 0.5) / kFine - 1.0));
  std::size_t at = 0;
  for (int k = 0; k <= kSteps; ++k) {
    const double target = cumulative.back() * k / kSteps;
    while (at + 1 < kFine && cumulative[at + 1] < target) ++at;
    const double width = cumulative[at + 1] - cumulative[at];
    const double part = width > 0.0 ? (target - cumulative[at]) / width : 0.0;
    inverse_[k] = static_cast<float>(2.0 * (static_cast<double>(at) + part) / kFine - 1.0);
  }
}

float FilterSampler::sample(float u) const {
  if (filter_ == PixelFilter::kBox) return (2.0f * u - 1.0f) * radius_;
  const float t = u * kSteps;
  const int i = std::min(static_cast<int>(t), kSteps - 1);
  const float f = t - static_cast<float>(i);
  return (inverse_[i] + f * (inverse_[i + 1] - inverse_[i])) * radius_;
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "renderer/film/pixel_accumulator.h"

namespace morsel::render {

void PixelAccumulator::add(const PathSample& sample, float x, float y, std::uint32_t index) {
  ++samples_;
  color_.add(sample.radiance);
  squares_.add(sample.radiance);
  for (int i = 0; i < 3; ++i) {
    albedo_[i].add(sample.albedo[i]);
    normal_[i].add(sample.normal[i]);
  }
  alpha_.add(sample.alpha);
  steps_ += static_cast<std::int64_t>(sample.steps);
  brightest_ = std::max(brightest_, luminance(sample.radiance));
  const float distance = square(x - 0.5f) + square(y - 0.5f);
  if (distance < nearest_ || (distance == nearest_ && index < nearest_index_)) {
    nearest_ = distance;
    nearest_index_ = index;
    depth_ = sample.depth;
    component_ = sample.component;
    for (int i = 0; i < 3; ++i) {
      position_[i] = sample.position[i];
      geometric_normal_[i] = sample.geometric_normal[i];
    }
  }
}

void PixelAccumulator::add(const PixelAccumulator& other) {
  samples_ += other.samples_;
  color_.add(other.color_);
  squares_.add(other.squares_);
  for (int i = 0; i < 3; ++i) {
    albedo_[i].add(other.albedo_[i]);
    normal_[i].add(other.normal_[i]);
  }
  alpha_.add(other.alpha_);
  steps_ += other.steps_;
  brightest_ = std::max(brightest_, other.brightest_);
  if (other.nearest_ < nearest_ ||
      (other.nearest_ == nearest_ && other.nearest_index_ < nearest_index_)) {
    nearest_ = other.nearest_;
    nearest_index_ = other.nearest_index_;
    depth_ = other.depth_;
    component_ = other.component_;
    std::copy(other.position_, other.position_ + 3, position_);
    std::copy(other.geometric_normal_, other.geometric_normal_ + 3, geometric_normal_);
  }
}

bool PixelAccumulator::is_possible(std::uint32_t most) const {
  const auto is_sum = [&](const SmallSum& sum) { return sum.is_sum_of(samples_); };
  const std::int64_t most_steps = std::int64_t{samples_} << 40;
  const auto is_finite = [](float x) { return std::isfinite(x); };
  return samples_ <= most && color_.is_sum_of(samples_) && squares_.is_sum_of_squares() &&
         std::all_of(albedo_, albedo_ + 3, is_sum) && std::all_of(normal_, normal_ + 3, is_sum) &&
         is_sum(alpha_) && steps_ >= 0 && steps_ <= most_steps && !std::isnan(nearest_) &&
         is_finite(depth_) && is_finite(component_) &&
         std::all_of(position_, position_ + 3, is_finite) &&
         std::all_of(geometric_normal_, geometric_normal_ + 3, is_finite) &&
         is_finite(brightest_) && brightest_ >= 0.0f;
}

bool PixelAccumulator::firefly() const {
  const V3f sum(color_.mean(1.0));
  return samples_ >= 16 && brightest_ > 0.5f * luminance(sum);
}

Pixel PixelAccumulator::result() const {
  Pixel pixel;
  pixel.samples = samples_;
  if (samples_ == 0) return pixel;
  const double n = samples_;
  pixel.color = V3f(color_.mean(n));
  pixel.alpha = alpha_.mean(n);
  for (int i = 0; i < 3; ++i) {
    pixel.albedo[i] = albedo_[i].mean(n);
    pixel.normal[i] = normal_[i].mean(n);
  }
  pixel.depth = depth_;
  pixel.component = component_;
  pixel.position = V3f(position_[0], position_[1], position_[2]);
  pixel.geometric_normal = V3f(geometric_normal_[0], geometric_normal_[1], geometric_normal_[2]);
  pixel.steps = static_cast<float>(static_cast<double>(steps_) / n);
  constexpr double kLargest = std::numeric_limits<float>::max();
  for (int i = 0; i < 3; ++i) {
    // One sample says nothing about its variance; the sample itself is the only scale there is.
    const double sum = color_.value(i);
    const double deviations =
        samples_ > 1 ? (squares_.value(i) - sum * sum / n) / (n - 1.0) : squares_.value(i);
    pixel.variance[i] = squares_.saturated(i)
                            ? std::numeric_limits<float>::max()
                            : static_cast<float>(std::clamp(deviations / n, 0.0, kLargest));
  }
  return pixel;
}

}  // namespace morsel::render

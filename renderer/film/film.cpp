// SPDX-License-Identifier: Apache-2.0
#include "renderer/film/film.h"

#include <fmt/format.h>

#include <limits>
#include <stdexcept>

namespace morsel::render {

void PixelAccumulator::add(const PathSample& sample, float x, float y) {
  ++samples_;
  const Imath::V3d color(sample.radiance);
  const Imath::V3d before = color - color_;
  color_ += before / static_cast<double>(samples_);
  squared_deviation_ += before * (color - color_);
  const float y_of_color = luminance(sample.radiance);
  const double deviation = y_of_color - luminance_mean_;
  luminance_mean_ += deviation / samples_;
  luminance_deviation_ += deviation * (y_of_color - luminance_mean_);
  brightest_ = std::max(brightest_, y_of_color);
  for (std::uint32_t i = 0; i < kMaxLightGroups; ++i) groups_[i] += sample.groups[i];
  steps_ += sample.steps;
  albedo_ += sample.albedo;
  normal_ += sample.normal;
  alpha_ += sample.alpha;
  const float distance = square(x - 0.5f) + square(y - 0.5f);
  if (distance < nearest_) {
    nearest_ = distance;
    depth_ = sample.depth;
    component_ = sample.component;
    position_ = sample.position;
    geometric_normal_ = sample.geometric_normal;
  }
}

Pixel PixelAccumulator::result() const {
  Pixel pixel;
  pixel.samples = samples_;
  if (samples_ == 0) return pixel;
  const double n = samples_;
  const float scale = static_cast<float>(1.0 / n);
  pixel.color = V3f(color_);
  pixel.alpha = alpha_ * scale;
  pixel.albedo = albedo_ * scale;
  pixel.normal = normal_ * scale;
  pixel.depth = depth_;
  pixel.component = component_;
  pixel.position = position_;
  pixel.geometric_normal = geometric_normal_;
  pixel.steps = steps_ * scale;
  // One sample says nothing about its variance; the sample itself is the only scale there is.
  const Imath::V3d variance = samples_ > 1 ? squared_deviation_ / (n * (n - 1.0)) : color_ * color_;
  for (int i = 0; i < 3; ++i)
    pixel.variance[i] =
        static_cast<float>(std::min(variance[i], double{std::numeric_limits<float>::max()}));
  return pixel;
}

Film::Film(const RenderSettings& settings, std::size_t light_groups)
    : full_width_(settings.width),
      full_height_(settings.height),
      window_(settings.crop.value_or(Crop{0, 0, settings.width, settings.height})) {
  if (full_width_ < 1 || full_height_ < 1)
    throw std::invalid_argument(
        fmt::format("film: image of {} x {} pixels", full_width_, full_height_));
  if (window_.x0 < 0 || window_.y0 < 0 || window_.x1 > full_width_ || window_.y1 > full_height_ ||
      window_.x0 >= window_.x1 || window_.y0 >= window_.y1)
    throw std::invalid_argument(fmt::format(
        "film: crop [{}, {}) x [{}, {}) is empty or not inside the image of {} x {} pixels",
        window_.x0, window_.x1, window_.y0, window_.y1, full_width_, full_height_));
  const std::size_t count = static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
  pixels_.resize(count);
  groups_.assign(light_groups, std::vector<V3f>(count, V3f(0.0f)));
  if (settings.cryptomatte) mattes_.assign(3, std::vector<cryptomatte::Ranks>(count));
}

}  // namespace morsel::render

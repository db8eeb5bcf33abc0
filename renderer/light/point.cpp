// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/point.h"

#include <fmt/format.h>

#include <stdexcept>

namespace morsel::render {

Point::Point(const PointLight& light) : position_(light.position), intensity_(light.intensity) {
  const float length2 = dot(light.direction, light.direction);
  if (!is_finite(position_) || !is_finite(intensity_) || !(length2 > 0.0f) ||
      !std::isfinite(length2))
    throw std::invalid_argument(fmt::format(
        "point light '{}': position, intensity and direction must be finite", light.name));
  axis_ = normalize(light.direction);
  const auto cosine_of = [](float degrees) { return std::cos(degrees * (kPi / 180.0f)); };
  outer_cosine_ = light.outer_angle >= 180.0f ? -2.0f : cosine_of(light.outer_angle);
  scale_ = 1.0f / std::max(1e-3f, cosine_of(light.inner_angle) - outer_cosine_);
}

float Point::falloff(const V3f& w) const {
  if (outer_cosine_ < -1.0f) return 1.0f;
  return square(std::clamp((dot(w, axis_) - outer_cosine_) * scale_, 0.0f, 1.0f));
}

LightSample Point::sample(const V3f& p, const V2f& /*u*/) const {
  const V3f d = position_ - p;
  const float distance2 = dot(d, d);
  if (!(distance2 > 0.0f)) return {};
  LightSample s;
  s.distance = std::sqrt(distance2);
  s.wi = d / s.distance;
  s.radiance = intensity_ * (falloff(-s.wi) / distance2);
  s.pdf = 1.0f;
  s.delta = true;
  return s;
}

float Point::importance(const V3f& p) const {
  const V3f d = p - position_;
  const float distance2 = dot(d, d);
  if (!(distance2 > 0.0f)) return 0.0f;
  return luminance(intensity_) * falloff(d / std::sqrt(distance2)) / distance2;
}

LightBounds Point::bounds() const {
  LightBounds b;
  b.low = b.high = position_;
  b.power = luminance(intensity_);
  return b;
}

}  // namespace morsel::render

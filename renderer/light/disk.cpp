// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/disk.h"

#include <fmt/format.h>

#include <stdexcept>

#include "renderer/math/frame.h"
#include "renderer/math/warp.h"

namespace morsel::render {

Disk::Disk(const DiskLight& light)
    : centre_(light.position), radiance_(light.radiance), radius_(light.radius) {
  const float length2 = dot(light.normal, light.normal);
  if (!is_finite(centre_) || !std::isfinite(radius_) || !(radius_ > 0.0f) || !(length2 > 0.0f) ||
      !std::isfinite(length2))
    throw std::invalid_argument(fmt::format(
        "disk light '{}': position, normal and radius must be finite and not zero", light.name));
  normal_ = normalize(light.normal);
  area_ = kPi * radius_ * radius_;
}

LightSample Disk::sample(const V3f& p, const V2f& u) const {
  const V2f d = square_to_disk(u);
  const Frame frame(normal_);
  const V3f to_light = centre_ + (frame.x * d.x + frame.y * d.y) * radius_ - p;
  const float distance2 = dot(to_light, to_light);
  LightSample s;
  s.distance = std::sqrt(distance2);
  s.wi = to_light / s.distance;
  const float cosine = -dot(s.wi, normal_);
  if (!(distance2 > 0.0f) || !(cosine > 0.0f)) return {};
  s.pdf = distance2 / (cosine * area_);
  s.radiance = radiance_;
  return s;
}

float Disk::pdf(const V3f& /*p*/, const V3f& wi, float distance) const {
  const float cosine = -dot(wi, normal_);
  return cosine > 0.0f ? distance * distance / (cosine * area_) : 0.0f;
}

float Disk::importance(const V3f& p) const {
  const V3f d = p - centre_;
  const float height = dot(d, normal_);
  if (height <= 0.0f) return 0.0f;
  const float distance2 = dot(d, d);
  // A lower bound on the cosine, since the nearer edge of a large light is seen less slanted.
  const float cosine = std::max(height / std::sqrt(distance2), 0.05f);
  return luminance(radiance_) * area_ * cosine / (distance2 + 0.25f * area_);
}

LightBounds Disk::bounds() const {
  LightBounds b;
  for (int i = 0; i < 3; ++i) {
    const float extent = radius_ * std::sqrt(std::max(0.0f, 1.0f - square(normal_[i])));
    b.low[i] = centre_[i] - extent;
    b.high[i] = centre_[i] + extent;
  }
  b.axis = normal_;
  b.spread = 0.0f;
  b.power = luminance(radiance_) * area_;
  return b;
}

}  // namespace morsel::render

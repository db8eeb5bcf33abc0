// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/ball.h"

#include <fmt/format.h>

#include <stdexcept>

#include "renderer/math/frame.h"

namespace morsel::render {

Ball::Ball(const SphereLight& light)
    : centre_(light.position), radiance_(light.radiance), radius_(light.radius) {
  if (!is_finite(centre_) || !(radius_ > 0.0f) || !std::isfinite(radius_))
    throw std::invalid_argument(fmt::format(
        "sphere light '{}': position and radius must be finite, the radius positive", light.name));
}

double Ball::rim(const V3f& p) const {
  const V3d d = V3d(centre_) - V3d(p);
  const double sine2 = double{radius_} * radius_ / d.dot(d);
  // 1 - sqrt(1 - s), without the cancellation.
  return sine2 < 1.0 ? sine2 / (1.0 + std::sqrt(1.0 - sine2)) : 0.0;
}

LightSample Ball::sample(const V3f& p, const V2f& u) const {
  const double height = rim(p);
  if (!(height > 0.0)) return {};
  const V3d d = V3d(centre_) - V3d(p);
  const double distance = std::sqrt(d.dot(d));
  const double drop = u.x * height;  // 1 - cos
  const double sine2 = drop * (2.0 - drop);
  const double sine = std::sqrt(std::max(0.0, sine2));
  const float phi = 2.0f * kPi * u.y;
  const Frame frame(V3f(d / distance));
  LightSample s;
  s.wi = normalize(frame.to_world(V3f(static_cast<float>(sine) * std::cos(phi),
                                      static_cast<float>(sine) * std::sin(phi),
                                      static_cast<float>(1.0 - drop))));
  s.distance = static_cast<float>(
      distance * (1.0 - drop) -
      std::sqrt(std::max(0.0, double{radius_} * radius_ - distance * distance * sine2)));
  s.pdf = static_cast<float>(1.0 / (2.0 * 3.14159265358979323846 * height));
  s.radiance = radiance_;
  return s;
}

float Ball::pdf(const V3f& p, const V3f& /*wi*/, float /*distance*/) const {
  const double height = rim(p);
  return height > 0.0 ? static_cast<float>(1.0 / (2.0 * 3.14159265358979323846 * height)) : 0.0f;
}

float Ball::importance(const V3f& p) const {
  const V3f d = p - centre_;
  const float distance2 = dot(d, d), radius2 = square(radius_);
  return distance2 > radius2 ? luminance(radiance_) * kPi * radius2 / distance2 : 0.0f;
}

LightBounds Ball::bounds() const {
  LightBounds b;
  b.low = centre_ - V3f(radius_);
  b.high = centre_ + V3f(radius_);
  b.power = luminance(radiance_) * kPi * square(radius_);
  return b;
}

}  // namespace morsel::render

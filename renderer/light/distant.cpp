// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/distant.h"

#include <fmt/format.h>

#include <stdexcept>

#include "renderer/math/frame.h"

namespace morsel::render {
namespace {

constexpr double kDoublePi = 3.14159265358979323846;

}  // namespace

Distant::Distant(const DistantLight& light) : irradiance_(light.irradiance), radiance_(0.0f) {
  const float length2 = dot(light.direction, light.direction);
  if (!(length2 > 0.0f) || !std::isfinite(length2) || !is_finite(irradiance_))
    throw std::invalid_argument(
        fmt::format("distant light '{}': direction and irradiance must be finite", light.name));
  towards_ = normalize(-light.direction);
  const double half = 0.5 * light.angular_diameter * kDoublePi / 180.0;
  rim_ = 2.0 * std::sin(0.5 * half) * std::sin(0.5 * half);
  // Irradiance of a disk about the normal: pi sin^2(half) times its radiance.
  if (rim_ > 0.0) radiance_ = irradiance_ / static_cast<float>(kDoublePi * rim_ * (2.0 - rim_));
}

bool Distant::contains(const V3f& wi) const {
  // 1 - cos = |a - b|^2 / 2 for unit vectors, without cancellation.
  const V3d d = V3d(wi) - V3d(towards_);
  return 0.5 * d.dot(d) <= rim_;
}

V3f Distant::radiance(const V3f& wi) const {
  return !delta() && contains(wi) ? radiance_ : V3f(0.0f);
}

LightSample Distant::sample(const V2f& u) const {
  LightSample s;
  s.distance = std::numeric_limits<float>::infinity();
  if (delta()) {
    s.wi = towards_;
    s.radiance = irradiance_;
    s.pdf = 1.0f;
    s.delta = true;
    return s;
  }
  const double drop = u.x * rim_;
  const auto sine = static_cast<float>(std::sqrt(drop * (2.0 - drop)));
  const float phi = 2.0f * kPi * u.y;
  s.wi = normalize(Frame(towards_).to_world(
      V3f(sine * std::cos(phi), sine * std::sin(phi), static_cast<float>(1.0 - drop))));
  s.radiance = radiance_;
  s.pdf = static_cast<float>(1.0 / (2.0 * kDoublePi * rim_));
  return s;
}

float Distant::pdf(const V3f& wi) const {
  return !delta() && contains(wi) ? static_cast<float>(1.0 / (2.0 * kDoublePi * rim_)) : 0.0f;
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/math/vector.h"

// Maps from the unit square to domains that are sampled.
namespace morsel::render {

// Uniform on the unit disk. Concentric squares become concentric circles, so neighbouring samples
// stay neighbours: Shirley & Chiu, "A Low Distortion Map Between Disk and Square", 1997.
inline V2f square_to_disk(const V2f& u) {
  const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
  if (a == 0.0f && b == 0.0f) return {0.0f, 0.0f};
  float radius, angle;
  if (std::abs(a) > std::abs(b)) {
    radius = a;
    angle = (kPi / 4.0f) * (b / a);
  } else {
    radius = b;
    angle = (kPi / 2.0f) - (kPi / 4.0f) * (a / b);
  }
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

// About +z with density cos(theta) / pi.
inline V3f square_to_cosine_hemisphere(const V2f& u) {
  const V2f d = square_to_disk(u);
  return {d.x, d.y, std::sqrt(std::max(0.0f, 1.0f - d.x * d.x - d.y * d.y))};
}

}  // namespace morsel::render

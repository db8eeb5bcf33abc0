// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/math/sine_cosine.h"
#include "renderer/math/vector.h"

// Maps from the unit square to domains that are sampled.
namespace morsel::render {

// Uniform on the unit disk. Concentric squares become concentric circles, so neighbouring samples
// stay neighbours: Shirley & Chiu, "A Low Distortion Map Between Disk and Square", 1997.
inline V2f square_to_disk(const V2f& u) {
  const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
  // On the square's two triangles left and right of its diagonals the ring's radius is a, above and
  // below b. No branch: no processor foresees which.
  const bool wide = std::abs(a) > std::abs(b);
  const float radius = wide ? a : b, along = wide ? b : a;
  const float share = along / (radius == 0.0f ? 1.0f : radius);
  const SineCosine angle = sine_cosine_of_eighth((kPi / 4.0f) * share);
  const float near = radius * angle.cosine, off = radius * angle.sine;
  return {wide ? near : off, wide ? off : near};
}

// About +z with density cos(theta) / pi.
inline V3f square_to_cosine_hemisphere(const V2f& u) {
  const V2f d = square_to_disk(u);
  return {d.x, d.y, std::sqrt(std::max(0.0f, 1.0f - d.x * d.x - d.y * d.y))};
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "renderer/accel/interaction.h"

namespace morsel::render {

// The next greater float than a finite one: a few instructions where std::nextafter is a call.
inline float next_up(float x) {
  if (x == 0.0f) return std::numeric_limits<float>::denorm_min();
  return std::bit_cast<float>(std::bit_cast<std::int32_t>(x) + (x > 0.0f ? 1 : -1));
}

// `x` rounded to float towards the infinity that has the sign of `direction`. Without branches that
// depend on how x would be rounded, which no processor predicts.
inline float rounded_towards(double x, double direction) {
  const auto nearest = static_cast<float>(x);
  const int up = direction > 0.0, above_zero = nearest > 0.0f;
  const int step = (up & (nearest < x)) | ((direction < 0.0) & (nearest > x));
  if (nearest == 0.0f && step != 0) [[unlikely]]
    return up ? next_up(0.0f) : -next_up(0.0f);
  const int outward = 1 - 2 * (up ^ above_zero);  // whether the magnitude grows
  return std::bit_cast<float>(std::bit_cast<std::int32_t>(nearest) + step * outward);
}

// `p` moved by `offset` along `direction` and rounded to float away from where it came, so that
// rounding never undoes a part of the offset.
inline V3f moved_outward(const V3d& p, const V3d& direction, double offset) {
  V3f out;
  for (int i = 0; i < 3; ++i) out[i] = rounded_towards(p[i] + offset * direction[i], direction[i]);
  return out;
}

// Spawn points on both sides of a plane through `p` (world space) with unit `normal`.
inline void set_spawn_points(const V3d& p, const V3d& normal, double offset,
                             SurfaceInteraction& s) {
  s.spawn_front = moved_outward(p, normal, offset);
  s.spawn_behind = moved_outward(p, -normal, offset);
}

}  // namespace morsel::render

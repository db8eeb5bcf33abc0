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

// `p` moved by `offset` along `direction` and rounded to float away from where it came, so that
// rounding never undoes a part of the offset.
inline V3f moved_outward(const V3d& p, const V3d& direction, double offset) {
  V3f out;
  for (int i = 0; i < 3; ++i) {
    const double exact = p[i] + offset * direction[i];
    auto rounded = static_cast<float>(exact);
    if (direction[i] > 0.0 && rounded < exact)
      rounded = next_up(rounded);
    else if (direction[i] < 0.0 && rounded > exact)
      rounded = -next_up(-rounded);
    out[i] = rounded;
  }
  return out;
}

// Spawn points on both sides of a plane through `p` (world space) with unit `normal`.
inline void set_spawn_points(const V3d& p, const V3d& normal, double offset,
                             SurfaceInteraction& s) {
  s.spawn_front = moved_outward(p, normal, offset);
  s.spawn_behind = moved_outward(p, -normal, offset);
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/accel/interaction.h"

namespace morsel::render {

// `p` moved by `offset` along `direction` and rounded to float away from where it came, so that
// rounding never undoes a part of the offset.
inline V3f moved_outward(const V3d& p, const V3d& direction, double offset) {
  V3f out;
  for (int i = 0; i < 3; ++i) {
    const double exact = p[i] + offset * direction[i];
    auto rounded = static_cast<float>(exact);
    if (direction[i] > 0.0 && rounded < exact)
      rounded = std::nextafter(rounded, std::numeric_limits<float>::infinity());
    else if (direction[i] < 0.0 && rounded > exact)
      rounded = std::nextafter(rounded, -std::numeric_limits<float>::infinity());
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

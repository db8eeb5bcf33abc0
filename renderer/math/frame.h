// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/math/vector.h"

namespace morsel::render {

// A right-handed orthonormal basis whose z axis is given. Local directions have z along it.
struct Frame {
  V3f x, y, z;

  // `normal` is a unit vector. Continuous but for one point, without a branch on the direction:
  // Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
  explicit Frame(const V3f& normal) : z(normal) {
    const float sign = std::copysign(1.0f, z.z);
    const float a = -1.0f / (sign + z.z);
    const float b = z.x * z.y * a;
    x = V3f(1.0f + sign * z.x * z.x * a, sign * b, -sign * z.x);
    y = V3f(b, sign + z.y * z.y * a, -z.y);
  }

  V3f to_local(const V3f& v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
  V3f to_world(const V3f& v) const { return x * v.x + y * v.y + z * v.z; }
};

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

namespace morsel::render {

inline Imath::V3f to_float(const Imath::V3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// Angle between `a` and `b` so small that their cross product gives no direction.
inline bool nearly_parallel(const Imath::V3d& a, const Imath::V3d& b) {
  return a.cross(b).length() <= 1e-6 * a.length() * b.length();
}

}  // namespace morsel::render

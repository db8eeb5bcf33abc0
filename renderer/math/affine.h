// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <cmath>

namespace morsel::render {

// Whether the linear part has an inverse that double precision can represent; relative to its size.
inline bool is_invertible(const Imath::M44d& transform) {
  double product = 1;
  Imath::V3d rows[3];
  for (int i = 0; i < 3; ++i) {
    rows[i] = Imath::V3d(transform[i][0], transform[i][1], transform[i][2]);
    product *= rows[i].length();
  }
  const double determinant = rows[0].dot(rows[1].cross(rows[2]));
  return std::isfinite(product) && product > 1e-200 && std::abs(determinant) > 1e-12 * product;
}

}  // namespace morsel::render

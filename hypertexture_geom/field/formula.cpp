// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/formula.h"

#include <limits>

namespace morsel::geom {

topology::LocalModel ModelScope::squares(const SumOfSquares& q) const {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  double a[6] = {}, size = 0.0;
  for (const Imath::V3d& row : q.rows) {
    for (int k = 0; k < 6; ++k) a[k] += row[jets::kPair[k][0]] * row[jets::kPair[k][1]];
    size += row.length2();
  }
  topology::LocalModel m = quadratic_model(box_, q.origin, q.constant, Imath::V3d(0.0), a);
  // The matrix is off from the sum of squares by a few roundings of at most |row|^2 in each entry.
  Imath::V3d reach;
  for (int i = 0; i < 3; ++i)
    reach[i] = std::max(std::abs(box_.min[i] - q.origin[i]), std::abs(box_.max[i] - q.origin[i]));
  const double unit = 8.0 * kEpsilon * size, far = reach.x + reach.y + reach.z;
  m.value_error += unit * far * far;
  m.gradient_error += Imath::V3d(2.0 * unit * far);
  m.hessian_error += 2.0 * unit;
  return m;
}

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/formula.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace morsel::geom {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

}  // namespace

topology::LocalModel ModelScope::squares(const SumOfSquares& q) const {
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

topology::LocalModel compose_linear(const topology::LocalModel& f, const UnivariateModel& phi,
                                    double extra) {
  using namespace topology::monomial;
  const double g[3] = {f.c[kX], f.c[kY], f.c[kZ]};
  const double a1 = phi.a[1], a2 = phi.a[2], a3 = phi.a[3];
  topology::LocalModel m;
  m.centre = f.centre;
  m.half = f.half;
  auto& c = m.c;
  c[k1] = phi.a[0];
  constexpr int kSquare[3] = {kXX, kYY, kZZ}, kCube[3] = {kXXX, kYYY, kZZZ};
  for (int i = 0; i < 3; ++i) {
    c[kX + i] = a1 * g[i];
    c[kSquare[i]] = a2 * g[i] * g[i];
    c[kCube[i]] = a3 * g[i] * g[i] * g[i];
  }
  c[kXY] = 2.0 * a2 * g[0] * g[1];
  c[kXZ] = 2.0 * a2 * g[0] * g[2];
  c[kYZ] = 2.0 * a2 * g[1] * g[2];
  c[kXXY] = 3.0 * a3 * g[0] * g[0] * g[1];
  c[kXXZ] = 3.0 * a3 * g[0] * g[0] * g[2];
  c[kXYY] = 3.0 * a3 * g[0] * g[1] * g[1];
  c[kYYZ] = 3.0 * a3 * g[1] * g[1] * g[2];
  c[kXZZ] = 3.0 * a3 * g[0] * g[2] * g[2];
  c[kYZZ] = 3.0 * a3 * g[1] * g[2] * g[2];
  c[kXYZ] = 6.0 * a3 * g[0] * g[1] * g[2];
  // f is off by `off` and each slope by its error; h is the reach of the linear part. Roundings of
  // the coefficients are a few units of the terms' sizes.
  constexpr double kUp = 1.0 + 1e-12, kRound = 16.0 * kEpsilon;
  double h = 0.0, steepest = 0.0, wrong = 0.0;
  for (int i = 0; i < 3; ++i) {
    h += std::abs(g[i]) * f.half[i];
    steepest = std::max(steepest, std::abs(g[i]) + f.gradient_error[i]);
    wrong = std::max(wrong, f.gradient_error[i]);
  }
  const double off = f.value_error + extra, reach = (h + off) * kUp;
  const double slope = std::abs(a1) + reach * (2.0 * std::abs(a2) + reach * 3.0 * std::abs(a3));
  const double bend = 2.0 * std::abs(a2) + reach * 6.0 * std::abs(a3);
  m.value_error =
      (phi.error[0] + slope * off + kRound * (std::abs(phi.a[0]) + slope * reach)) * kUp;
  for (int i = 0; i < 3; ++i)
    m.gradient_error[i] = ((phi.error[1] + bend * off + kRound * (slope + bend * reach)) *
                               (std::abs(g[i]) + f.gradient_error[i]) +
                           slope * f.gradient_error[i]) *
                          kUp;
  m.hessian_error =
      ((phi.error[2] + 6.0 * std::abs(a3) * off + kRound * (bend + 6.0 * std::abs(a3) * reach)) *
           steepest * steepest +
       bend * wrong * (2.0 * steepest + wrong) + (slope + phi.error[1]) * f.hessian_error) *
      kUp;
  forget_nans(m);
  m.add_rounding();
  return m;
}

}  // namespace morsel::geom

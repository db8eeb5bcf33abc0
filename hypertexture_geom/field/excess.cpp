// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/excess.h"

#include <limits>

namespace morsel::geom {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// p^2 for |t - centre| <= reach. The products of degree 4 to 6 in e = t - centre are replaced by
// lower ones: e^4 ~ 3/2 h^2 e^2 - 9/32 h^4 (value within 9/32 h^4, slope h^3, second derivative 9
// h^2), the rest by nothing.
UnivariateModel squared(const UnivariateModel& p, double reach) {
  const double *a = p.a, h = reach, h2 = h * h;
  UnivariateModel r;
  r.centre = p.centre;
  r.a[0] = a[0] * a[0];
  r.a[1] = 2.0 * a[0] * a[1];
  r.a[2] = 2.0 * a[0] * a[2] + a[1] * a[1];
  r.a[3] = 2.0 * (a[0] * a[3] + a[1] * a[2]);
  const double fourth = 2.0 * a[1] * a[3] + a[2] * a[2];
  r.a[2] += 1.5 * fourth * h2;
  r.a[0] -= 9.0 / 32.0 * fourth * h2 * h2;
  const double four = std::abs(fourth), five = 2.0 * std::abs(a[2] * a[3]), six = a[3] * a[3];
  // What |p| and its derivatives can be.
  const double b0 = std::abs(a[0]), b1 = std::abs(a[1]), b2 = std::abs(a[2]), b3 = std::abs(a[3]);
  const double v = b0 + h * (b1 + h * (b2 + h * b3)), s = b1 + h * (2.0 * b2 + h * 3.0 * b3),
               b = 2.0 * b2 + 6.0 * h * b3;
  const double* e = p.error;
  constexpr double kUp = 1.0 + 1e-12, kRound = 32.0 * kEpsilon, kUnderflow = 1e-290;
  r.error[0] = (h2 * h2 * (9.0 / 32.0 * four + h * (five + h * six)) + e[0] * (2.0 * v + e[0]) +
                kRound * v * v) *
                   kUp +
               kUnderflow;
  r.error[1] = (h2 * h * (four + h * (5.0 * five + h * 6.0 * six)) +
                2.0 * (e[1] * (v + e[0]) + s * e[0]) + kRound * 4.0 * v * s) *
                   kUp +
               kUnderflow;
  r.error[2] = (h2 * (9.0 * four + h * (20.0 * five + h * 30.0 * six)) +
                2.0 * (e[2] * (v + e[0]) + e[1] * (2.0 * s + e[1]) + b * e[0]) +
                kRound * 16.0 * (v * b + s * s)) *
                   kUp +
               kUnderflow;
  return r;
}

}  // namespace

topology::LocalModel squared_excess(const ModelScope& at, const Imath::V3d& axis,
                                    const Imath::V3d& origin, double half, double k) {
  using topology::Interval;
  const topology::LocalModel u = at.linear(axis, origin);
  const Interval range = u.range(), shift = Interval::point(half);
  const double centre = u.c[0];
  const UnivariateModel low = smooth_abs_model(centre - half, range - shift, k),
                        high = smooth_abs_model(centre + half, range + shift, k);
  const double h = std::max(range.hi - centre, centre - range.lo) * (1.0 + 1e-12) + 1e-300;
  UnivariateModel e;
  e.centre = centre;
  double d[4];  // the coefficients' rounding
  for (int i = 0; i < 4; ++i) {
    e.a[i] = 0.5 * (low.a[i] + high.a[i]);
    d[i] = 4.0 * kEpsilon * (std::abs(low.a[i]) + std::abs(high.a[i]));
  }
  e.a[0] += k - half;
  d[0] += 4.0 * kEpsilon * (k + half);
  const double rounding[3] = {d[0] + h * (d[1] + h * (d[2] + h * d[3])),
                              d[1] + h * (2.0 * d[2] + h * 3.0 * d[3]),
                              2.0 * d[2] + 6.0 * h * d[3]};
  for (int i = 0; i < 3; ++i)
    e.error[i] = (0.5 * (low.error[i] + high.error[i]) + rounding[i]) * (1.0 + 1e-12);
  // Nor is centre -+ half exact.
  return compose_linear(u, squared(e, h), 4.0 * kEpsilon * (std::abs(centre) + half));
}

}  // namespace morsel::geom

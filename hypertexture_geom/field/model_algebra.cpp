// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/model_algebra.h"

#include <algorithm>
#include <cmath>

#include "hypertexture_geom/field/local_series.h"

namespace morsel::geom {
namespace {

using topology::Box;
using topology::Interval;
using topology::LocalModel;
using namespace topology::monomial;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUnderflow = 1e-290;

// A bound made by multiplications: infinite rather than NaN.
double or_infinity(double x) { return x >= 0.0 ? x : kInfinity; }

LocalModel finished(LocalModel m) {
  forget_nans(m);
  m.add_rounding();
  return m;
}

// Bounds on a function's derivatives over its box.
struct Derivatives {
  double gradient[3];
  double hessian[6];
};

Derivatives derivatives_of(const LocalModel& f) {
  constexpr int kPair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  Derivatives d;
  for (int i = 0; i < 3; ++i) d.gradient[i] = f.gradient_range(i).magnitude();
  for (int k = 0; k < 6; ++k) d.hessian[k] = f.hessian_range(kPair[k][0], kPair[k][1]).magnitude();
  return d;
}

// Derivatives of g(f) for |g'| <= slope, |g''| <= bend, as the remainder of a series.
void add_outer_remainder(LocalSeries& series, const Derivatives& f, double value, double slope,
                         double bend) {
  constexpr int kPair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  Imath::V3d gradient;
  double hessian[6];
  for (int i = 0; i < 3; ++i) gradient[i] = slope * f.gradient[i];
  for (int k = 0; k < 6; ++k)
    hessian[k] = bend * f.gradient[kPair[k][0]] * f.gradient[kPair[k][1]] + slope * f.hessian[k];
  series.add_remainder(value, gradient, hessian);
}

// A polynomial model, or the plain ranges where these are clearly better: a polynomial's value is
// bound to its slopes, which pays when it is combined with other terms.
const LocalModel& better(const LocalModel& polynomial, const LocalModel& plain) {
  const double value = plain.range().width() / polynomial.range().width();
  if (value < 0.7) return plain;
  double a = 0.0, b = 0.0;
  for (int i = 0; i < 3; ++i) {
    a += plain.gradient_range(i).width();
    b += polynomial.gradient_range(i).width();
  }
  return value * (a / b) < 0.5 ? plain : polynomial;
}

}  // namespace

void forget_nans(LocalModel& m) {
  for (const double c : m.c)
    if (!std::isfinite(c)) {
      m.c = {};
      m.value_error = kInfinity;
      m.gradient_error = Imath::V3d(kInfinity);
      m.hessian_error = kInfinity;
    }
  m.value_error = or_infinity(m.value_error);
  for (int i = 0; i < 3; ++i) m.gradient_error[i] = or_infinity(m.gradient_error[i]);
  m.hessian_error = or_infinity(m.hessian_error);
}

LocalModel empty_model(const Box& box) {
  LocalModel m;
  m.centre = topology::centre(box);
  for (int i = 0; i < 3; ++i) {
    const double c = m.centre[i];
    const double reach = std::max(box.max[i] - c, c - box.min[i]);
    // Exact for the dyadic boxes of the topology stage: then no widening is needed.
    const bool exact =
        box.max[i] - c == c - box.min[i] && c + reach == box.max[i] && c - reach == box.min[i];
    m.half[i] = exact ? reach : reach * (1.0 + 4.0 * kEpsilon);
  }
  return m;
}

LocalModel constant_model(const Box& box, double value, double error) {
  LocalModel m = empty_model(box);
  m.c[k1] = value;
  m.value_error = error;
  return finished(m);
}

LocalModel coordinate_model(const Box& box, int axis) {
  LocalModel m = empty_model(box);
  m.c[k1] = m.centre[axis];
  m.c[kX + axis] = 1.0;
  return finished(m);
}

LocalModel quadratic_model(const Box& box, const Imath::V3d& origin, double c, const Imath::V3d& b,
                           const double (&a)[6]) {
  LocalModel m = empty_model(box);
  const Imath::V3d d = m.centre - origin;
  const double rows[3][3] = {{a[0], a[3], a[4]}, {a[3], a[1], a[5]}, {a[4], a[5], a[2]}};
  // Sums of absolute values, for the rounding of the value and the slopes at the centre.
  double size = std::abs(c);
  m.c[k1] = c;
  for (int i = 0; i < 3; ++i) {
    double ad = 0.0, absolute = 0.0;
    for (int j = 0; j < 3; ++j) {
      ad += rows[i][j] * d[j];
      absolute += std::abs(rows[i][j] * d[j]);
    }
    m.c[k1] += d[i] * (b[i] + ad);
    m.c[kX + i] = b[i] + 2.0 * ad;
    m.c[kXX + i] = a[i];
    size += std::abs(d[i]) * (std::abs(b[i]) + absolute);
    const double slope = 16.0 * kEpsilon * (std::abs(b[i]) + 2.0 * absolute) + kUnderflow;
    m.gradient_error[i] += slope;
    m.value_error += slope * m.half[i];
  }
  m.c[kXY] = 2.0 * a[3];
  m.c[kXZ] = 2.0 * a[4];
  m.c[kYZ] = 2.0 * a[5];
  m.value_error += 32.0 * kEpsilon * size + kUnderflow;
  return finished(m);
}

LocalModel add(const LocalModel& f, const LocalModel& g) {
  LocalModel m = f;
  for (int i = 0; i < kCount; ++i) m.c[i] += g.c[i];
  m.value_error += g.value_error;
  m.gradient_error += g.gradient_error;
  m.hessian_error += g.hessian_error;
  return finished(m);
}

LocalModel subtract(const LocalModel& f, const LocalModel& g) { return add(f, negate(g)); }

LocalModel negate(LocalModel f) {
  for (double& c : f.c) c = -c;
  return f;
}

LocalModel scale(LocalModel f, double factor) {
  const double size = std::abs(factor);
  for (double& c : f.c) c *= factor;
  f.value_error *= size;
  f.gradient_error *= size;
  f.hessian_error *= size;
  return finished(f);
}

LocalModel add_constant(LocalModel f, double constant) {
  f.c[k1] += constant;
  return finished(f);
}

LocalModel product(const LocalModel& f, const LocalModel& g) {
  return (LocalSeries(f) * LocalSeries(g)).finish();
}

LocalModel compose(const LocalModel& f, const UnivariateModel& phi) {
  const Derivatives d = derivatives_of(f);
  LocalSeries t(f);
  t.drop_constant();
  LocalSeries r = t;
  r *= phi.a[3];
  r += phi.a[2];
  r = r * t;
  r += phi.a[1];
  r = r * t;
  r += phi.a[0];
  add_outer_remainder(r, d, phi.error[0], phi.error[1], phi.error[2]);
  const LocalModel m = r.finish();
  LocalModel plain;
  plain.centre = f.centre;
  plain.half = f.half;
  plain.c[k1] = phi.value.middle();
  const double slope = phi.slope.magnitude();
  const double error = std::max(phi.value.hi - plain.c[k1], plain.c[k1] - phi.value.lo);
  LocalSeries s(plain);
  add_outer_remainder(s, d, error, slope, phi.bend);
  return better(m, s.finish());
}

LocalModel compose(const LocalModel& f, const LocalModel (&y)[3]) {
  // Y_i = y_i - centre_i, of which the constant term is the inner centre's offset.
  const auto moved = [&](int i) {
    LocalSeries s(y[i]);
    s += -f.centre[i];
    return s;
  };
  const LocalSeries Y[3] = {moved(0), moved(1), moved(2)};
  const auto& c = f.c;
  // Horner's scheme by the first factor: P = c_1 + sum_i Y_i A_i.
  const auto sum = [&](double constant, double a, int i, double b, int j, double e, int k) {
    LocalSeries s = Y[i];
    s *= a;
    LocalSeries other = Y[j];
    other *= b;
    s += other;
    LocalSeries third = Y[k];
    third *= e;
    s += third;
    s += constant;
    return s;
  };
  LocalSeries z = Y[2] * sum(c[kZZ], c[kZZZ], 2, 0.0, 0, 0.0, 1);
  z += c[kZ];
  LocalSeries r = Y[2] * z;
  LocalSeries ay = Y[1] * sum(c[kYY], c[kYYY], 1, c[kYYZ], 2, 0.0, 0);
  LocalSeries yz = Y[2] * sum(c[kYZ], c[kYZZ], 2, 0.0, 0, 0.0, 1);
  ay += yz;
  ay += c[kY];
  r += Y[1] * ay;
  LocalSeries ax = Y[0] * sum(c[kXX], c[kXXX], 0, c[kXXY], 1, c[kXXZ], 2);
  LocalSeries xy = Y[1] * sum(c[kXY], c[kXYY], 1, c[kXYZ], 2, 0.0, 0);
  LocalSeries xz = Y[2] * sum(c[kXZ], c[kXZZ], 2, 0.0, 0, 0.0, 1);
  ax += xy;
  ax += xz;
  ax += c[kX];
  r += Y[0] * ax;
  r += c[k1];
  // The outer model's errors go through the chain rule.
  constexpr int kPair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  Derivatives d[3];
  for (int i = 0; i < 3; ++i) d[i] = derivatives_of(y[i]);
  Imath::V3d gradient(0.0);
  double hessian[6] = {};
  for (int i = 0; i < 3; ++i)
    for (int a = 0; a < 3; ++a) gradient[i] += f.gradient_error[a] * d[a].gradient[i];
  for (int k = 0; k < 6; ++k) {
    double at_i = 0.0, at_j = 0.0;
    for (int a = 0; a < 3; ++a) {
      hessian[k] += f.gradient_error[a] * d[a].hessian[k];
      at_i += d[a].gradient[kPair[k][0]];
      at_j += d[a].gradient[kPair[k][1]];
    }
    hessian[k] += f.hessian_error * at_i * at_j;
  }
  r.add_remainder(f.value_error, gradient, hessian);
  const LocalModel m = r.finish();
  // Where the image is too wide for f's polynomial, f's plain ranges.
  const Interval range = f.range();
  const Derivatives g = derivatives_of(f);
  for (int i = 0; i < 3; ++i) {
    gradient[i] = 0.0;
    for (int a = 0; a < 3; ++a) gradient[i] += g.gradient[a] * d[a].gradient[i];
  }
  for (int k = 0; k < 6; ++k) {
    hessian[k] = 0.0;
    for (int a = 0; a < 3; ++a) {
      hessian[k] += g.gradient[a] * d[a].hessian[k];
      for (int b = 0; b < 3; ++b)
        hessian[k] += g.hessian[a == b ? a : 2 + a + b] * d[a].gradient[kPair[k][0]] *
                      d[b].gradient[kPair[k][1]];
    }
  }
  LocalModel plain;
  plain.centre = y[0].centre;
  plain.half = y[0].half;
  plain.c[k1] = range.middle();
  LocalSeries s(plain);
  s.add_remainder(std::max(range.hi - plain.c[k1], plain.c[k1] - range.lo), gradient, hessian);
  return better(m, s.finish());
}

}  // namespace morsel::geom

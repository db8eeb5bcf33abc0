// SPDX-License-Identifier: Apache-2.0
// Models of common functions: enclosures of their derivatives.
#include <algorithm>
#include <cmath>

#include "hypertexture_geom/field/univariate_model.h"

namespace morsel::geom {
namespace {

using topology::Interval;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUnderflow = 1e-290;

Interval constant(double x) { return Interval::point(x); }

Interval widened(double x, double relative) {
  const double w = std::abs(x) * relative + kUnderflow;
  return topology::outward(x - w, x + w);
}

// Errors of glibc's exp, log and pow are below 2 units in the last place; 16 are allowed for.
constexpr double kLibm = 16.0 * std::numeric_limits<double>::epsilon();

}  // namespace

UnivariateModel square_model(double centre, Interval range) {
  const Interval value = topology::square(constant(centre));
  UnivariateModel m;
  m.centre = centre;
  m.a[0] = value.middle();
  m.a[1] = 2.0 * centre;
  m.a[2] = 1.0;
  m.error[0] = value.width();
  m.value = topology::square(range);
  m.slope = constant(2.0) * range;
  m.bend = 2.0;
  return m;
}

UnivariateModel sqrt_model(double centre, Interval range, double least) {
  range.lo = std::max(range.lo, least);
  range.hi = std::max(range.hi, range.lo);
  return univariate_model(centre, range, [](Interval t) {
    const Interval root = topology::sqrt(t), inverse = constant(1.0) / t;
    DerivativeRanges d;
    d[0] = root;
    d[1] = constant(0.5) / root;
    d[2] = constant(-0.5) * d[1] * inverse;
    d[3] = constant(-1.5) * d[2] * inverse;
    d[4] = constant(-2.5) * d[3] * inverse;
    d[5] = constant(-3.5) * d[4] * inverse;
    return d;
  });
}

namespace {

Interval clamped(Interval x, double bound) {
  return {std::max(x.lo, -bound), std::min(x.hi, bound)};
}

}  // namespace

// With x = t / k these are k^(1 - n) times functions of x alone; those of odd order are odd.
std::array<Interval, 7> smooth_abs_ranges(Interval t, double k) {
  const Interval kk = constant(k), one = constant(1.0);
  const Interval x = t / kk, square = topology::square(x);
  const Interval r = topology::sqrt(one + square), inverse = one / r,
                 i2 = topology::square(inverse);
  // t / r keeps growing with t, and its range on an interval is that of the ends.
  const auto sign_at = [&](double at) {
    if (std::isinf(at)) return constant(at > 0.0 ? 1.0 : -1.0);
    const Interval y = constant(at) / kk;
    return y / topology::sqrt(one + topology::square(y));
  };
  const Interval sign = clamped(topology::hull(sign_at(t.lo), sign_at(t.hi)), 1.0);
  const Interval i3 = inverse * i2, i4 = i2 * i2;
  std::array<Interval, 7> h;
  // x^2 / (r + 1) rather than r - 1: no cancellation near 0. It grows with |x|.
  const auto height_at = [&](double at) {
    if (std::isinf(at)) return constant(at);
    const Interval y2 = topology::square(constant(at) / kk);
    return kk * (y2 / (topology::sqrt(one + y2) + one));
  };
  h[0] = {std::max(0.0, height_at(t.mignitude()).lo), height_at(t.magnitude()).hi};
  h[1] = sign;
  h[2] = i3 / kk;
  // With s = x / r: s^2 + 1 / r^2 = 1.
  const Interval k2 = kk * kk, s2 = clamped(topology::square(sign), 1.0);
  h[3] = constant(-3.0) * sign * i4 / k2;
  h[4] = constant(3.0) * (constant(4.0) * s2 - i2) * (i4 * inverse) / (k2 * kk);
  h[5] = constant(15.0) * sign * (constant(3.0) * i2 - constant(4.0) * s2) * (i4 * i2) / (k2 * k2);
  h[6] = constant(45.0) * (i4 - constant(12.0) * i2 * s2 + constant(8.0) * s2 * s2) * (i4 * i3) /
         (k2 * k2 * kk);
  return h;
}

UnivariateModel smooth_abs_model(double centre, Interval range, double k) {
  return univariate_model(centre, range, [k](Interval t) {
    const std::array<Interval, 7> d = smooth_abs_ranges(t, k);
    return DerivativeRanges{d[0], d[1], d[2], d[3], d[4], d[5]};
  });
}

UnivariateModel smooth_sign_model(double centre, Interval range, double k) {
  return univariate_model(centre, range, [k](Interval t) {
    const std::array<Interval, 7> d = smooth_abs_ranges(t, k);
    return DerivativeRanges{d[1], d[2], d[3], d[4], d[5], d[6]};
  });
}

UnivariateModel exp_model(double centre, Interval range) {
  const Interval lo = widened(std::exp(range.lo), kLibm), hi = widened(std::exp(range.hi), kLibm);
  const Interval all{std::max(0.0, lo.lo), hi.hi};
  TaylorData data;
  data.value = data.slope = data.bend = all;
  if (std::isfinite(range.width())) {
    const Interval middle = widened(std::exp(range.middle()), kLibm);
    std::fill(data.at_middle, data.at_middle + 5, middle);
    data.fourth_deviation = (all - middle).magnitude();
    data.fifth = all.hi;
  }
  return univariate_model(centre, range, data);
}

UnivariateModel log_model(double centre, Interval range, double least) {
  range.lo = std::max(range.lo, least);
  range.hi = std::max(range.hi, range.lo);
  const auto derivatives = [](Interval t, Interval(&d)[5]) {
    const Interval inverse = constant(1.0) / t, i2 = inverse * inverse;
    d[0] = {widened(std::log(t.lo), kLibm).lo, widened(std::log(t.hi), kLibm).hi};
    d[1] = inverse;
    d[2] = -i2;
    d[3] = constant(2.0) * i2 * inverse;
    d[4] = constant(-6.0) * i2 * i2;
  };
  TaylorData data;
  Interval all[5];
  derivatives(range, all);
  data.value = all[0];
  data.slope = all[1];
  data.bend = all[2];
  if (std::isfinite(range.width())) {
    derivatives(constant(range.middle()), data.at_middle);
    data.fourth_deviation = (all[4] - data.at_middle[4]).magnitude();
    const Interval inverse = constant(1.0) / constant(range.lo), i2 = inverse * inverse;
    data.fifth = (constant(24.0) * i2 * i2 * inverse).magnitude();
  }
  return univariate_model(centre, range, data);
}

UnivariateModel pow_model(double centre, Interval range, double p, double least) {
  range.lo = std::max(range.lo, least);
  range.hi = std::max(range.hi, range.lo);
  // p (p - 1) ... (p - n + 1) t^(p - n); powers are monotone in t.
  const auto derivative = [p](Interval t, int n) {
    Interval factor = constant(1.0), exponent = constant(p);
    for (int i = 0; i < n; ++i) factor = factor * (constant(p) - constant(i));
    exponent = exponent - constant(n);
    // The exponent's rounding moves the power by its logarithm times as much.
    const auto power = [&](double at) {
      const double q = p - n, value = std::pow(at, q);
      const double wobble = exponent.width() * std::abs(std::log(at));
      return widened(value, kLibm + 2.0 * wobble);
    };
    return factor * topology::hull(power(t.lo), power(t.hi));
  };
  TaylorData data;
  data.value = derivative(range, 0);
  data.slope = derivative(range, 1);
  data.bend = derivative(range, 2);
  if (std::isfinite(range.width())) {
    for (int n = 0; n < 5; ++n) data.at_middle[n] = derivative(constant(range.middle()), n);
    data.fourth_deviation = (derivative(range, 4) - data.at_middle[4]).magnitude();
    data.fifth = derivative(range, 5).magnitude();
  }
  return univariate_model(centre, range, data);
}

UnivariateModel smooth_step_model(double centre, Interval range) {
  TaylorData data;
  // On [0, 1]; p'' has its extremes +-10 / sqrt(3) at (3 -+ sqrt(3)) / 6.
  const auto derivative = [](Interval t, int n) {
    const Interval f = constant(60.0) * t;
    switch (n) {
      case 0:
        return t * t * t * (constant(10.0) + t * (constant(6.0) * t - constant(15.0)));
      case 1:
        return constant(30.0) * topology::square(t * (constant(1.0) - t));
      case 2:
        return f * (constant(1.0) + t * (constant(2.0) * t - constant(3.0)));
      case 3:
        return constant(60.0) + constant(360.0) * t * (t - constant(1.0));
      default:
        return constant(720.0) * t - constant(360.0);
    }
  };
  const Interval t{std::clamp(range.lo, 0.0, 1.0), std::clamp(range.hi, 0.0, 1.0)};
  const auto at = [&](double x, int n) { return derivative(constant(x), n); };
  data.value = {std::max(0.0, at(t.lo, 0).lo), std::min(1.0, at(t.hi, 0).hi)};
  data.slope = topology::hull(at(t.lo, 1), at(t.hi, 1));
  if (t.contains(0.5)) data.slope = topology::hull(data.slope, at(0.5, 1));
  data.bend = topology::hull(at(t.lo, 2), at(t.hi, 2));
  constexpr double kFlat = 0.2113248654051871, kTop = 5.773502691896258 * (1.0 + 1e-14);
  if (t.lo <= kFlat + 1e-15 && t.hi >= kFlat - 1e-15) data.bend.hi = kTop;
  if (t.lo <= 1.0 - kFlat + 1e-15 && t.hi >= 1.0 - kFlat - 1e-15) data.bend.lo = -kTop;
  if (range.lo >= 0.0 && range.hi <= 1.0) {
    for (int n = 0; n < 5; ++n) data.at_middle[n] = at(range.middle(), n);
    data.fifth = 720.0;
    data.fourth_deviation = 720.0 * (range.hi - range.lo);
  } else if (std::isfinite(range.width())) {
    // The third derivative jumps at 0 and 1: no Taylor polynomial, but the lines and parabolas.
    const double x = std::clamp(range.middle(), 0.0, 1.0);
    for (int n = 0; n < 2; ++n) data.at_middle[n] = at(x, n);
  }
  return univariate_model(centre, range, data);
}

}  // namespace morsel::geom

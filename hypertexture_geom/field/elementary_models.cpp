// SPDX-License-Identifier: Apache-2.0
// Models of common functions: enclosures of their derivatives.
#include <algorithm>
#include <cmath>

#include "hypertexture_geom/field/univariate_model.h"

namespace morsel::geom {
namespace {

using topology::Interval;

constexpr double kUnderflow = 1e-250;  // a quotient that underflows, times powers of 1 / k

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

// With x = t / k these are k^(1 - n) times functions of x alone; those of odd order are odd. With s
// = x / r, i = 1 / r, r = sqrt(1 + x^2):
//   s, i^3, -3 s i^4, 3 (4 s^2 - i^2) i^5, 15 s (3 i^2 - 4 s^2) i^6, 45 (i^4 - 12 i^2 s^2 + 8 s^4)
//   i^7
// for the orders 1 to 6. This is the inner loop of fits, hence plain arithmetic, widened once:
// fewer than 60 roundings lie behind any of them, relative to the sum of absolute values.
std::array<Interval, 7> smooth_abs_ranges(Interval t, double k) {
  constexpr double kRelative = 64.0 * std::numeric_limits<double>::epsilon();
  const auto wide = [](double lo, double hi, double size) -> Interval {
    const double w = kRelative * size + kUnderflow;
    if (std::isnan(lo) || std::isnan(hi) || std::isnan(w)) return Interval::whole();
    return {lo - w, hi + w};
  };
  // c p for p >= 0.
  const auto times = [&](Interval c, Interval p, double size) {
    return wide(c.lo < 0.0 ? c.lo * p.hi : c.lo * p.lo, c.hi < 0.0 ? c.hi * p.lo : c.hi * p.hi,
                size * p.hi);
  };
  const double near = t.mignitude() / k, far = t.magnitude() / k;
  const double r_near = std::sqrt(1.0 + near * near), r_far = std::sqrt(1.0 + far * far);
  const Interval i{1.0 / r_far, 1.0 / r_near};
  const auto sign = [&](double at) {
    const double x = at / k;
    return std::isinf(x * x) ? std::copysign(1.0, x) : x / std::sqrt(1.0 + x * x);
  };
  const Interval s{sign(t.lo), sign(t.hi)};
  const double low = s.mignitude(), high = s.magnitude();
  const Interval s2{low * low, high * high}, i2{i.lo * i.lo, i.hi * i.hi};
  const Interval i3{i2.lo * i.lo, i2.hi * i.hi}, i4{i2.lo * i2.lo, i2.hi * i2.hi};
  const auto power = [&](Interval a, Interval b, double scale) -> Interval {
    return {a.lo * b.lo * scale, a.hi * b.hi * scale};
  };
  const double k1 = 1.0 / k, k2 = k1 * k1, k3 = k2 * k1;
  std::array<Interval, 7> h;
  // x^2 / (r + 1) rather than r - 1: no cancellation near 0.
  const double top = std::isinf(far * far) ? far : far * (far / (r_far + 1.0));
  const double bottom =
      std::isinf(near * near) ? near * (1.0 - kRelative) - 1.0 : near * (near / (r_near + 1.0));
  h[0] = wide(k * bottom, k * top, k * top);
  h[0].lo = std::max(0.0, k * bottom * (1.0 - kRelative) - kUnderflow);
  h[1] = {std::max(-1.0, s.lo - kRelative * std::abs(s.lo) - kUnderflow),
          std::min(1.0, s.hi + kRelative * std::abs(s.hi) + kUnderflow)};
  h[2] = wide(i3.lo * k1, i3.hi * k1, i3.hi * k1);
  h[3] = times({-s.hi, -s.lo}, power(i4, {3.0, 3.0}, k2), high);
  h[4] = times({4.0 * s2.lo - i2.hi, 4.0 * s2.hi - i2.lo}, power(i4, {3.0 * i.lo, 3.0 * i.hi}, k3),
               4.0 * s2.hi + i2.hi);
  // s times a bracket of either sign: the four products.
  const Interval bracket{3.0 * i2.lo - 4.0 * s2.hi, 3.0 * i2.hi - 4.0 * s2.lo};
  const double a = s.lo * bracket.lo, b = s.lo * bracket.hi, c = s.hi * bracket.lo,
               d = s.hi * bracket.hi;
  h[5] =
      times({std::min({a, b, c, d}), std::max({a, b, c, d})},
            power(i4, {15.0 * i2.lo, 15.0 * i2.hi}, k2 * k2), high * (3.0 * i2.hi + 4.0 * s2.hi));
  h[6] = times({i4.lo - 12.0 * i2.hi * s2.hi + 8.0 * s2.lo * s2.lo,
                i4.hi - 12.0 * i2.lo * s2.lo + 8.0 * s2.hi * s2.hi},
               power(i4, {45.0 * i3.lo, 45.0 * i3.hi}, k2 * k3),
               i4.hi + 12.0 * i2.hi * s2.hi + 8.0 * s2.hi * s2.hi);
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

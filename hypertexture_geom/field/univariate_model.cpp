// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/univariate_model.h"

#include <algorithm>
#include <cmath>

namespace morsel::geom {
namespace {

using topology::Interval;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUp = 1.0 + 1e-13;  // covers the rounding of a bound made of a few operations
constexpr double kUnderflow = 1e-290;

// A polynomial about `origin` with interval coefficients and errors.
struct Candidate {
  Interval b[4] = {};
  double error[3] = {};
};

double or_infinity(double x) { return x >= 0.0 ? x : kInfinity; }

// Re-expands about `centre`; the coefficients' widths join the errors.
UnivariateModel shifted(const Candidate& p, double origin, double centre, Interval range) {
  Interval a[4] = {p.b[0], p.b[1], p.b[2], p.b[3]};
  if (centre != origin) {
    const Interval s = Interval::point(centre) - Interval::point(origin),
                   two = Interval::point(2.0), three = Interval::point(3.0);
    a[2] = p.b[2] + three * s * p.b[3];
    a[1] = p.b[1] + s * (two * p.b[2] + three * s * p.b[3]);
    a[0] = p.b[0] + s * (p.b[1] + s * (p.b[2] + s * p.b[3]));
  }
  UnivariateModel m;
  m.centre = centre;
  double width[4];
  bool finite = true;
  for (int i = 0; i < 4; ++i) {
    m.a[i] = a[i].middle();
    width[i] = std::max(a[i].hi - m.a[i], m.a[i] - a[i].lo);
    finite = finite && std::isfinite(m.a[i]) && std::isfinite(width[i]);
  }
  if (!finite) {
    std::fill(m.a, m.a + 4, 0.0);
    std::fill(m.error, m.error + 3, kInfinity);
    return m;
  }
  const double e = std::max(range.hi - centre, centre - range.lo);
  // A coefficient that is exact contributes nothing, however wide the range.
  const auto times = [](double x, double y) { return x == 0.0 || y == 0.0 ? 0.0 : x * y; };
  const double extra[3] = {width[0] + times(e, width[1] + times(e, width[2] + times(e, width[3]))),
                           width[1] + times(e, 2.0 * width[2] + times(e, 3.0 * width[3])),
                           2.0 * width[2] + times(e, 6.0 * width[3])};
  for (int i = 0; i < 3; ++i) m.error[i] = or_infinity((p.error[i] + extra[i]) * kUp + kUnderflow);
  return m;
}

Interval constant(double x) { return Interval::point(x); }

Interval widened(double x, double relative) {
  const double w = std::abs(x) * relative + kUnderflow;
  return topology::outward(x - w, x + w);
}

// Errors of glibc's exp, log and pow are below 2 units in the last place; 16 are allowed for.
constexpr double kLibm = 16.0 * std::numeric_limits<double>::epsilon();

}  // namespace

UnivariateModel univariate_model(double centre, Interval range, const TaylorData& data) {
  UnivariateModel best;
  best.centre = centre;
  std::fill(best.error, best.error + 3, kInfinity);
  const auto offer = [&](const Candidate& p, double origin) {
    const UnivariateModel m = shifted(p, origin, centre, range);
    if (m.error[0] < best.error[0] || (!(best.error[0] < m.error[0]) && m.error[1] < best.error[1]))
      best = m;
  };
  const double bend = data.bend.magnitude();
  // The plain range.
  {
    Candidate p;
    p.b[0] = constant(std::isfinite(data.value.width()) ? data.value.middle() : 0.0);
    p.error[0] = std::max(data.value.hi - p.b[0].lo, p.b[0].lo - data.value.lo) * kUp;
    p.error[1] = data.slope.magnitude();
    p.error[2] = bend;
    offer(p, centre);
  }
  const double middle = range.middle();
  const double e = std::max(range.hi - middle, middle - range.lo) * kUp;
  if (std::isfinite(e)) {
    // A line with the middle slope.
    Candidate line;
    line.b[0] = data.at_middle[0];
    line.b[1] = constant(data.slope.middle());
    line.error[1] = std::max(data.slope.hi - line.b[1].lo, line.b[1].lo - data.slope.lo) * kUp;
    line.error[0] = line.error[1] * e;
    line.error[2] = bend;
    if (std::isfinite(line.b[1].lo)) offer(line, middle);
    // A parabola with the middle second derivative and the slope it has in the middle.
    Candidate parabola;
    parabola.b[0] = data.at_middle[0];
    parabola.b[1] = data.at_middle[1];
    parabola.b[2] = constant(0.5 * data.bend.middle());
    parabola.error[2] =
        std::max(data.bend.hi - data.bend.middle(), data.bend.middle() - data.bend.lo) * kUp;
    parabola.error[1] = parabola.error[2] * e;
    parabola.error[0] = 0.5 * parabola.error[2] * e * e;
    if (std::isfinite(parabola.b[2].lo)) offer(parabola, middle);
    // Taylor's polynomial of degree 4 with e^4 replaced by 3/2 E^2 e^2 - 9/32 E^4 (within 9/32 E^4,
    // slope E^3, second derivative 9 E^2).
    Candidate cubic;
    const Interval fourth = data.at_middle[4] / constant(24.0),
                   square = topology::square(constant(e));
    cubic.b[0] = data.at_middle[0] - constant(9.0 / 32.0) * fourth * square * square;
    cubic.b[1] = data.at_middle[1];
    cubic.b[2] = data.at_middle[2] / constant(2.0) + constant(1.5) * fourth * square;
    cubic.b[3] = data.at_middle[3] / constant(6.0);
    const double f = fourth.magnitude();
    const double by_fifth = data.fifth * e / 5.0, d = std::min(by_fifth, data.fourth_deviation);
    cubic.error[0] = (9.0 / 32.0 * f + d / 24.0) * e * e * e * e;
    cubic.error[1] = (f + std::min(data.fifth * e / 4.0, data.fourth_deviation) / 6.0) * e * e * e;
    cubic.error[2] =
        (9.0 * f + std::min(data.fifth * e / 3.0, data.fourth_deviation) / 2.0) * e * e;
    offer(cubic, middle);
  }
  best.value = data.value;
  best.slope = data.slope;
  best.bend = bend;
  return best;
}

UnivariateModel square_model(double centre, Interval range) {
  Candidate p;
  p.b[2] = constant(1.0);
  UnivariateModel m = shifted(p, 0.0, centre, range);
  m.value = topology::square(range);
  m.slope = constant(2.0) * range;
  m.bend = 2.0;
  return m;
}

UnivariateModel sqrt_model(double centre, Interval range, double least) {
  range.lo = std::max(range.lo, least);
  range.hi = std::max(range.hi, range.lo);
  const auto derivatives = [](Interval t, Interval(&d)[5]) {
    const Interval root = topology::sqrt(t);
    d[0] = root;
    d[1] = constant(0.5) / root;
    d[2] = -(constant(0.25) / (root * t));
    d[3] = constant(0.375) / (root * t * t);
    d[4] = -(constant(0.9375) / (root * t * t * t));
  };
  TaylorData data;
  derivatives(constant(range.middle()), data.at_middle);
  Interval all[5];
  derivatives(range, all);
  data.value = all[0];
  data.slope = all[1];
  data.bend = all[2];
  data.fourth_deviation = (all[4] - data.at_middle[4]).magnitude();
  const Interval low = constant(range.lo);
  data.fifth = (constant(105.0 / 32.0) / (topology::sqrt(low) * low * low * low * low)).magnitude();
  return univariate_model(centre, range, data);
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
  // x^2 / (r + 1) rather than r - 1: no cancellation near 0.
  h[0] = std::isinf(t.magnitude()) ? Interval{0.0, kInfinity} : kk * (square / (r + one));
  if (h[0].lo < 0.0) h[0].lo = 0.0;
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

UnivariateModel univariate_model(double centre, Interval range,
                                 const std::function<DerivativeRanges(Interval)>& f) {
  const DerivativeRanges all = f(range);
  TaylorData data;
  data.value = all[0];
  data.slope = all[1];
  data.bend = all[2];
  if (std::isfinite(range.width())) {
    const DerivativeRanges middle = f(constant(range.middle()));
    std::copy(middle.begin(), middle.begin() + 5, data.at_middle);
    data.fourth_deviation = (all[4] - middle[4]).magnitude();
    data.fifth = all[5].magnitude();
  }
  return univariate_model(centre, range, data);
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

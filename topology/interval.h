// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace morsel::topology {

// A closed interval [lo, hi] of real numbers. The four operations widen the result outward by one
// unit in the last place plus the smallest normal number, which covers round-to-nearest and
// flush-to-zero alike. NaN never stands for a range: an undefined result is (-inf, +inf).
struct Interval {
  double lo = 0.0;
  double hi = 0.0;

  static Interval point(double x) { return {x, x}; }
  static Interval whole() {
    return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }

  bool contains(double x) const { return lo <= x && x <= hi; }
  double width() const { return hi - lo; }
  double middle() const { return 0.5 * (lo + hi); }
  // The largest absolute value in the interval.
  double magnitude() const { return std::max(std::abs(lo), std::abs(hi)); }
  // The smallest absolute value in the interval.
  double mignitude() const { return lo > 0.0 ? lo : (hi < 0.0 ? -hi : 0.0); }
};

// Widens [lo, hi], whose ends were each rounded once, so that it holds the exact ends.
inline Interval outward(double lo, double hi) {
  if (std::isnan(lo) || std::isnan(hi)) return Interval::whole();
  constexpr double kUlp = std::numeric_limits<double>::epsilon();
  constexpr double kTiny = 2.0 * std::numeric_limits<double>::min();
  return {lo - (std::abs(lo) * kUlp + kTiny), hi + (std::abs(hi) * kUlp + kTiny)};
}

inline Interval operator-(Interval a) { return {-a.hi, -a.lo}; }
inline Interval operator+(Interval a, Interval b) { return outward(a.lo + b.lo, a.hi + b.hi); }
inline Interval operator-(Interval a, Interval b) { return outward(a.lo - b.hi, a.hi - b.lo); }
inline Interval operator*(Interval a, Interval b) {
  const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  if (std::isnan(p) || std::isnan(q) || std::isnan(r) || std::isnan(s)) return Interval::whole();
  return outward(std::min(std::min(p, q), std::min(r, s)),
                 std::max(std::max(p, q), std::max(r, s)));
}
inline Interval operator/(Interval a, Interval b) {
  if (b.contains(0.0)) return Interval::whole();
  const double p = a.lo / b.lo, q = a.lo / b.hi, r = a.hi / b.lo, s = a.hi / b.hi;
  if (std::isnan(p) || std::isnan(q) || std::isnan(r) || std::isnan(s)) return Interval::whole();
  return outward(std::min(std::min(p, q), std::min(r, s)),
                 std::max(std::max(p, q), std::max(r, s)));
}

// x * x, never negative.
inline Interval square(Interval a) {
  const double lo = a.mignitude(), hi = a.magnitude();
  const Interval r = outward(lo * lo, hi * hi);
  return {std::max(0.0, r.lo), r.hi};
}

// Square root of the non-negative part; std::sqrt is correctly rounded.
inline Interval sqrt(Interval a) {
  const Interval r = outward(std::sqrt(std::max(0.0, a.lo)), std::sqrt(std::max(0.0, a.hi)));
  return {std::max(0.0, r.lo), r.hi};
}

// The smallest interval that holds both.
inline Interval hull(Interval a, Interval b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}

}  // namespace morsel::topology

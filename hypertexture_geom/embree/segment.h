// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace morsel::geom {

// What is known of g(t) = F(origin + t * direction) on an interval before g is evaluated: ranges of
// its first and second derivative. Finite, or as wide as one likes.
struct RayBounds {
  double slope_lo = 0.0, slope_hi = 0.0;
  double curvature_lo = 0.0, curvature_hi = 0.0;
};

struct SegmentResult {
  bool hit = false;
  // The evaluation limit was reached before the answer was certain: a hit is then a sign change,
  // but perhaps not the first one; a miss is only "none found".
  bool limit = false;
  double t = 0.0;       // of the hit
  double beyond = 0.0;  // >= t, within the tolerance of it, where the search for a next root starts
  int evaluations = 0;
};

inline constexpr int kMaxSegmentEvaluations = 256;

namespace detail {

// How far from an end of the interval g certainly keeps the sign it has there (`g` != 0). `up` and
// `down` are the greatest rates at which g can rise and fall on the way into the interval.
inline double reach(double g, double up, double down) {
  const double rate = g < 0.0 ? up : down;
  return rate > 0.0 ? std::abs(g) / rate : std::numeric_limits<double>::infinity();
}

// Whether g, which has one sign at both ends, can't reach zero between them. Its distance from the
// chord is at most c (t - a)(b - t) / 2, where c bounds the second derivative on the side that
// bends g towards zero (the error term of linear interpolation); the parabola chord - error has no
// zero in the interval iff c (b - a)^2 / 2 < (sqrt|ga| + sqrt|gb|)^2.
inline bool bends_short_of_zero(double ga, double gb, double width, const RayBounds& bounds) {
  const double c = ga < 0.0 ? -bounds.curvature_lo : bounds.curvature_hi;
  if (!(c > 0.0)) return true;
  const double p = std::abs(ga), q = std::abs(gb);
  return 0.5 * c * width * width < p + q + 2.0 * std::sqrt(p * q);
}

// The derivative's range on [a, b], whose mean slope is known: it differs from the mean by at most
// half the width times the greatest curvature.
inline RayBounds tightened(const RayBounds& bounds, double mean, double width) {
  RayBounds r = bounds;
  const double bend =
      0.5 * width * std::max(std::abs(bounds.curvature_lo), std::abs(bounds.curvature_hi));
  r.slope_lo = std::max(r.slope_lo, mean - bend);
  r.slope_hi = std::min(r.slope_hi, mean + bend);
  return r;
}

}  // namespace detail

// The only root of `g` in [a, b], where `ga` and `gb` have opposite signs. `least_slope` > 0 bounds
// |g'| from below: |t - root| <= |g(t)| / least_slope ends the iteration. Pass 0 when unknown.
// Secant and inverse quadratic steps, with bisection when two of them did not halve the bracket.
template <class Value>
SegmentResult refine_root(const Value& g, double a, double ga, double b, double gb,
                          double least_slope, double tolerance, SegmentResult result) {
  double c = a, gc = ga;  // the bracket's previous end
  bool have_third = false;
  double width_two_ago = std::numeric_limits<double>::infinity();
  double width_one_ago = width_two_ago;
  for (;;) {
    const double width = b - a;
    double t = a - ga * (width / (gb - ga));
    if (have_third && gc != ga && gc != gb) {
      const double s = a + ga * gb / ((gc - ga) * (gc - gb)) * (c - a) -
                       ga * gc / ((gb - ga) * (gb - gc)) * (width);
      if (s > a && s < b) t = s;
    }
    if (width > 0.5 * width_two_ago) t = 0.5 * (a + b);
    t = std::clamp(t, a, b);
    // Done when the bracket is, or can't be split any further.
    if (width <= tolerance || t == a || t == b || result.evaluations >= kMaxSegmentEvaluations) {
      result.limit = result.evaluations >= kMaxSegmentEvaluations && width > tolerance;
      result.hit = true;
      result.t = t;
      result.beyond = b;
      return result;
    }
    const double gt = g(t);
    ++result.evaluations;
    if (std::abs(gt) <= least_slope * tolerance) {
      // One more secant step is free: its points are known.
      const bool right = (gt < 0.0) == (ga < 0.0);
      const double slope = right ? (gb - gt) / (b - t) : (gt - ga) / (t - a);
      result.hit = true;
      result.t = gt == 0.0 || slope == 0.0 ? t : std::clamp(t - gt / slope, a, b);
      result.beyond = std::min(b, std::max(t, result.t) + tolerance);
      return result;
    }
    width_two_ago = width_one_ago;
    width_one_ago = width;
    have_third = true;
    if ((gt < 0.0) == (ga < 0.0)) {
      c = a, gc = ga;
      a = t, ga = gt;
    } else {
      c = b, gc = gb;
      b = t, gb = gt;
    }
  }
}

// The first t in [0, length] with g(t) = 0, found by proof: parts are skipped where the bounds on
// g' (from either end) or g'' (from both) exclude a root, a sign change over a monotone part is the
// one root there, anything else is split and its nearer half treated first. An interval narrower
// than `tolerance` is a hit iff g changes its sign over it. `strict` excludes t = 0 (a ray that
// starts on the surface): g's sign there is then that of g(tolerance). `any` is for shadows: the
// first sign change met ends the search, t is some point of its interval.
// References: Hart, "Sphere tracing" (1996) for the Lipschitz step; Galin et al., "Segment tracing
// using local Lipschitz bounds" (2020) for slope bounds per direction and interval.
template <class Value>
SegmentResult first_root(const Value& g, double length, const RayBounds& bounds, double tolerance,
                         bool strict, bool any = false) {
  struct Point {
    double t, g;
  };
  SegmentResult result;
  const auto evaluate = [&](double t) {
    ++result.evaluations;
    return g(t);
  };
  const auto hit_at = [&](double t) {
    result.hit = true;
    result.t = t;
    result.beyond = std::min(length, t + tolerance);
    return result;
  };

  Point a{0.0, evaluate(0.0)};
  if (a.g == 0.0) {
    if (!strict) return hit_at(0.0);
    a.t = std::min(tolerance, length);
    a.g = evaluate(a.t);
    if (a.g == 0.0) return a.t < length ? hit_at(a.t) : result;
  }
  if (!(a.t + detail::reach(a.g, bounds.slope_hi, -bounds.slope_lo) <= length)) return result;

  // Evaluated points to the right of `a`, the nearest last. Each halving adds at most one.
  constexpr int kStack = 64;
  std::array<Point, kStack> right;
  int size = 0;
  right[size++] = {length, evaluate(length)};

  while (size > 0) {
    const Point b = right[size - 1];
    const double width = b.t - a.t;
    if (b.g == 0.0) {
      // A root at the end of this part: still look for one before it, as if g kept its sign.
      if (width <= tolerance) return hit_at(b.t);
    }
    const bool changes = (a.g < 0.0) != (b.g < 0.0) || b.g == 0.0;
    if (changes && any) return hit_at(a.t);
    const RayBounds local =
        detail::tightened(bounds, width > 0.0 ? (b.g - a.g) / width : 0.0, width);
    if (changes) {
      if (width <= tolerance) return hit_at(a.t + 0.5 * width);
      if (local.slope_lo > 0.0 || local.slope_hi < 0.0) {
        if (b.g == 0.0) return hit_at(b.t);
        const double least = std::max(local.slope_lo, -local.slope_hi);
        return refine_root(g, a.t, a.g, b.t, b.g, least, tolerance, result);
      }
    } else if (width <= tolerance || detail::bends_short_of_zero(a.g, b.g, width, bounds)) {
      a = b;
      --size;
      continue;
    }
    const double from = a.t + detail::reach(a.g, local.slope_hi, -local.slope_lo);
    const double to = b.g == 0.0 ? b.t : b.t - detail::reach(b.g, -local.slope_lo, local.slope_hi);
    if (!changes && from > to) {
      a = b;
      --size;
      continue;
    }
    double middle = 0.5 * (from + to);
    if (!(middle > a.t && middle < b.t)) middle = 0.5 * (a.t + b.t);
    if (result.evaluations >= kMaxSegmentEvaluations || size == kStack || middle <= a.t ||
        middle >= b.t) {
      result.limit = true;
      // The nearest sign change that is known of.
      for (Point left = a; size > 0; left = right[--size]) {
        const Point& next = right[size - 1];
        if ((left.g < 0.0) == (next.g < 0.0) && next.g != 0.0) continue;
        result.hit = true;
        result.t = 0.5 * (left.t + next.t);
        result.beyond = next.t;
        break;
      }
      return result;
    }
    const Point m{middle, evaluate(middle)};
    if ((m.g < 0.0) != (a.g < 0.0) || m.g == 0.0) size = 0;  // a root before m: drop what follows
    right[size++] = m;
  }
  return result;
}

}  // namespace morsel::geom

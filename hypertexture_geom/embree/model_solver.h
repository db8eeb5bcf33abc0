// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include "hypertexture_geom/embree/ray_cubic.h"

namespace morsel::geom {

struct ModelResult {
  bool hit = false;
  bool limit = false;   // as SegmentResult's
  double s = 0.0;       // of the hit, in [0, 1]
  double beyond = 0.0;  // >= s, where the search for a next root starts
  // If has_gradient: of F at gradient_at, a place within a step of s.
  Imath::V3d gradient{0.0};
  double gradient_at = 0.0;
  bool has_gradient = false;
  int evaluations = 0;  // of F, with or without its derivatives
};

namespace detail {

// The root in [0, 1] of a cubic with one sign of slope and opposite signs at its ends: Newton's
// steps, with bisection when one leaves the bracket.
inline float monotone_root(const RayCubic& p) {
  float lo = 0.0f, hi = 1.0f, s = p.b[0] / (p.b[0] - p.b[3]);
  const bool rising = p.b[0] < 0.0f;
  for (int i = 0; i < 6; ++i) {
    const float value = p.value(s);
    ((value < 0.0f) == rising ? lo : hi) = s;
    const float next = s - value / p.slope(s);
    // Before the bracket is asked, of which s is an end: a step of no length is outside.
    if (std::abs(next - s) < 1e-6f) return std::clamp(next, 0.0f, 1.0f);
    s = next > lo && next < hi ? next : 0.5f * (lo + hi);
  }
  return s;
}

}  // namespace detail

// The first s in [0, 1] with g(s) = 0, g(s) = F(x(s)), by proof. `p` differs from g by no more than
// `error`. Parts of [0, 1] where p stays further than that from zero have no root and cost no
// evaluation of F. Where p crosses the whole error band with one sign of slope there is exactly one
// root, which is polished on F itself: the parabola q of F's value and slope at s and of p'' near s
// differs from F by at most half of what p'' varies and errs times (root - s)^2, and |root - s| <=
// |g(s)| / min|g'|; q's root is thus off by at most that over the least slope of q. Mostly one
// evaluation proves `tolerance` (in units of s). Where an end is within the band, but the slope has
// one sign, F's sign at that end decides. What is left, grazing rays, is halved up to kHalvings
// times and then handed to `first_root` (segment.h) with the slopes and curvatures that p and its
// errors give.
//   value(s) -> F;  with_gradient(s, gradient, slope) -> F, and sets its gradient and dF/ds
// `strict`, `any`: as first_root.
template <class Value, class WithGradient>
class ModelSolver {
 public:
  ModelSolver(const Value& value, const WithGradient& with_gradient, const RayCubicError& error,
              double tolerance)
      : value_(value), with_gradient_(with_gradient), error_(error), tolerance_(tolerance) {}

  ModelResult solve(const RayCubic& whole, bool strict, bool any) const {
    ModelResult result;
    // Most cubics are settled whole; the parts of the others wait in a stack, the nearest last.
    if (examine({whole, 0.0f, 0}, strict, any, result) != Verdict::kHalve) return result;
    Part stack[kHalvings + 2];
    int size = 0;
    const auto halve = [&](const Part& part) {
      RayCubic left, right;
      part.p.split(left, right);
      const float middle = part.from + std::ldexp(0.5f, -part.level);
      stack[size++] = {right, middle, part.level + 1};
      stack[size++] = {left, part.from, part.level + 1};
    };
    halve({whole, 0.0f, 0});
    while (size > 0) {
      const Part part = stack[--size];
      switch (examine(part, strict, any, result)) {
        case Verdict::kHit:
          return result;
        case Verdict::kHalve:
          halve(part);
          break;
        case Verdict::kNoRoot:
          break;
      }
    }
    return result;
  }

 private:
  static constexpr int kHalvings = 5;
  struct Part {
    RayCubic p;
    float from;  // it is [from, from + 2^-level]
    int level;
  };
  enum class Verdict { kNoRoot, kHit, kHalve };

  Verdict examine(const Part& part, bool strict, bool any, ModelResult& result) const {
    const RayCubic& p = part.p;
    const float e = error_.value;
    if (p.least() > e || p.greatest() < -e) return Verdict::kNoRoot;
    const float width = std::ldexp(1.0f, -part.level);
    float slope_lo, slope_hi;
    p.slopes(slope_lo, slope_hi);
    slope_lo -= error_.slope * width;
    slope_hi += error_.slope * width;
    const bool monotone = slope_lo > 0.0f || slope_hi < 0.0f;
    const bool starts_certain = std::abs(p.b[0]) > e, ends_certain = std::abs(p.b[3]) > e;
    if (starts_certain && ends_certain) {
      if ((p.b[0] < 0.0f) != (p.b[3] < 0.0f)) {
        if (any) {
          result.hit = true;
          result.s = part.from;
          result.beyond = part.from + width;
          return Verdict::kHit;
        }
        if (monotone &&
            polish(p, part.from, width, slope_lo, slope_hi, detail::monotone_root(p), result))
          return Verdict::kHit;
      } else if (monotone) {
        return Verdict::kNoRoot;
      }
    }
    // F settles what the band leaves open, best where it is monotone.
    const bool open = !(starts_certain && ends_certain);
    if (monotone && open) {
      const Verdict v = by_ends(p, part.from, width, slope_lo, slope_hi, starts_certain,
                                ends_certain, any, result);
      if (v != Verdict::kHalve) return v;
    }
    if ((monotone && open) || part.level == kHalvings)
      return by_field(p, part.from, width, slope_lo, slope_hi, strict && part.from == 0.0f, any,
                      result)
                 ? Verdict::kHit
                 : Verdict::kNoRoot;
    return Verdict::kHalve;
  }

  // A monotone part of which one end or both are within the band: F's signs there tell whether it
  // has a root. kHalve leaves it to by_field: F is zero at an end, or polishing fails.
  Verdict by_ends(const RayCubic& p, float from, float width, float slope_lo, float slope_hi,
                  bool starts_certain, bool ends_certain, bool any, ModelResult& result) const {
    const bool rising = slope_lo > 0.0f;
    double first = p.b[0], last = p.b[3];
    if (!starts_certain) {
      first = value_(static_cast<double>(from));
      ++result.evaluations;
      if (first == 0.0) return Verdict::kHalve;
      if ((first > 0.0) == rising) return Verdict::kNoRoot;  // away from zero
    }
    if (!ends_certain) {
      last = value_(static_cast<double>(from) + static_cast<double>(width));
      ++result.evaluations;
      if (last == 0.0) return Verdict::kHalve;
    }
    if ((first < 0.0) == (last < 0.0)) return Verdict::kNoRoot;
    if (any) {
      result.hit = true;
      result.s = from;
      result.beyond = from + width;
      return Verdict::kHit;
    }
    const auto guess = static_cast<float>(first / (first - last));
    return polish(p, from, width, slope_lo, slope_hi, guess, result) ? Verdict::kHit
                                                                     : Verdict::kHalve;
  }

  // The one root within the part, `guess` in [0, 1] being where about in it; false if proof fails
  // (rounding at the limit of float).
  bool polish(const RayCubic& p, float from, float width, float slope_lo, float slope_hi,
              float guess, ModelResult& result) const {
    const double inverse = 1.0 / width;
    const double least = std::max(slope_lo, -slope_hi) * inverse;
    const bool rising = slope_lo > 0.0f;
    const double first_bend = p.first_curvature(), last_bend = p.last_curvature();
    // p'' at a place of the part from 0 to 1, which it is outside of by rounding at most.
    const auto curvature = [&](double u) {
      return (first_bend + (last_bend - first_bend) * std::clamp(u, 0.0, 1.0)) * inverse * inverse;
    };
    double lo = from, hi = from + width;
    double s = from + width * guess;
    for (int i = 0; i < 6; ++i) {
      double slope = 0.0;
      const double g = with_gradient_(s, result.gradient, slope);
      ++result.evaluations;
      ((g < 0.0) == rising ? lo : hi) = s;
      if (!(rising ? slope > 0.0 : slope < 0.0)) return false;
      // q(d) = g + slope d + k d^2 / 2 is F at s + d but for `unsure` d^2 / 2, as far as the root
      // can be away.
      const double reach = std::abs(g) / least;
      const double k1 = curvature((s - reach - from) * inverse);
      const double k2 = curvature((s + reach - from) * inverse);
      const double k = 0.5 * (k1 + k2);
      const double unsure = 0.5 * std::abs(k1 - k2) + error_.curvature;
      const double newton = -g / slope;
      double step = -g / (slope + 0.5 * k * newton);
      double flattest = std::abs(slope) - std::abs(k) * reach;  // of q, within reach
      if (!(std::abs(step) <= reach && flattest > 0.5 * std::abs(slope))) {
        step = newton;
        flattest = 0.0;
      }
      const double next = s + step;
      if (!(next >= lo && next <= hi)) return false;
      const double rest = g + step * (slope + 0.5 * k * step);
      if (0.5 * unsure * reach * reach + std::abs(rest) <= tolerance_ * flattest) {
        result.hit = true;
        result.s = next;
        // Not `hi`, which may be the root itself: there F, rounded anew, may have either sign.
        result.beyond =
            std::min(static_cast<double>(from) + static_cast<double>(width), next + tolerance_);
        result.gradient_at = s;
        result.has_gradient = true;
        return true;
      }
      s = next;
    }
    return false;
  }

  bool by_field(const RayCubic& p, float from, float width, float slope_lo, float slope_hi,
                bool strict, bool any, ModelResult& result) const {
    float curvature_lo, curvature_hi;
    p.curvatures(curvature_lo, curvature_hi);
    const double inverse = 1.0 / width;
    const RayBounds bounds{slope_lo * inverse, slope_hi * inverse,
                           curvature_lo * inverse * inverse - error_.curvature,
                           curvature_hi * inverse * inverse + error_.curvature};
    const double start = from;
    const SegmentResult r = first_root([&](double t) { return value_(start + t); },
                                       static_cast<double>(width), bounds, tolerance_, strict, any);
    result.evaluations += r.evaluations;
    result.limit = result.limit || r.limit;
    if (!r.hit) return false;
    result.hit = true;
    result.s = start + r.t;
    result.beyond = start + r.beyond;
    return true;
  }

  const Value& value_;
  const WithGradient& with_gradient_;
  const RayCubicError& error_;
  double tolerance_;
};

}  // namespace morsel::geom

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
  // If has_gradient: of F at gradient_at, a place within a Newton step of s.
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
    const float step = next - s;
    s = next > lo && next < hi ? next : 0.5f * (lo + hi);
    if (std::abs(step) < 1e-6f) break;
  }
  return s;
}

}  // namespace detail

// The first s in [0, 1] with g(s) = 0, g(s) = F(x(s)), by proof. `p` differs from g by no more than
// `error`. Parts of [0, 1] where p stays further than that from zero have no root and cost no
// evaluation of F. Where p crosses the whole error band with one sign of slope there is exactly one
// root, which Newton's method on F itself polishes: its error after a step from s to s' is at most
// max|g''| (root - s)^2 / (2 |g'(s)|) and (root - s) <= |g(s)| / min|g'|, so that mostly one
// evaluation proves `tolerance` (in units of s). What is left - ends within the band, grazing rays
// - is halved up to kHalvings times and then handed to `first_root` (segment.h) with the slopes and
// curvatures that p and its errors give.
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
        if (monotone && polish(p, part.from, width, slope_lo, slope_hi, result))
          return Verdict::kHit;
      } else if (monotone) {
        return Verdict::kNoRoot;
      }
    }
    // F settles what the band leaves open, best where it is monotone.
    if ((monotone && !(starts_certain && ends_certain)) || part.level == kHalvings)
      return by_field(p, part.from, width, slope_lo, slope_hi, strict && part.from == 0.0f, any,
                      result)
                 ? Verdict::kHit
                 : Verdict::kNoRoot;
    return Verdict::kHalve;
  }

  // The one root within the part; false if proof fails (rounding at the limit of float).
  bool polish(const RayCubic& p, float from, float width, float slope_lo, float slope_hi,
              ModelResult& result) const {
    float curvature_lo, curvature_hi;
    p.curvatures(curvature_lo, curvature_hi);
    const double inverse = 1.0 / width;
    const double bend =
        std::max(std::abs(curvature_lo), std::abs(curvature_hi)) * inverse * inverse +
        error_.curvature;
    const double least = std::max(slope_lo, -slope_hi) * inverse;
    const bool rising = slope_lo > 0.0f;
    double lo = from, hi = from + width;
    double s = from + width * detail::monotone_root(p);
    for (int i = 0; i < 6; ++i) {
      double slope = 0.0;
      const double g = with_gradient_(s, result.gradient, slope);
      ++result.evaluations;
      ((g < 0.0) == rising ? lo : hi) = s;
      if (!(rising ? slope > 0.0 : slope < 0.0)) return false;
      const double step = -g / slope, reach = std::abs(g) / least;
      const double next = s + step;
      if (!(next >= lo && next <= hi)) return false;
      if (0.5 * bend * reach * reach <= tolerance_ * std::abs(slope)) {
        result.hit = true;
        result.s = next;
        result.beyond = std::min(hi, next + tolerance_);
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

// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/sphere_surface.h"

#include <limits>

#include "hypertexture_geom/embree/segment.h"

namespace morsel::geom {

bool SphereSurface::search(std::uint32_t, const RaySegment& ray, bool any, Root& root) const {
  ++ray_statistics().bricks;
  if (!is_valid(ray)) return false;
  double from = ray.tnear, to = ray.tfar;
  const double slack = 1e-7 * (box_.max - box_.min).length();
  if (!clip(box_, slack, ray, from, to)) return false;
  const double speed = ray.direction.length();
  if (!(speed > 0.0) || !(to - from < std::numeric_limits<double>::infinity())) return false;

  const Imath::V3d entry = ray.origin + ray.direction * from;
  const auto value = [&](double s) { return field_.value(entry + ray.direction * s); };
  const double length = to - from, rate = lipschitz_ * speed, least = tolerance() / speed;
  int evaluations = 1;
  double s = 0.0, g = value(0.0);
  if (g == 0.0) {
    if (from != ray.tnear) {
      root = {from, from + least, evaluations, false, {}};
      count(evaluations, false);
      return true;
    }
    s = least;  // the root that the ray starts on is not a hit
    g = value(s);
    ++evaluations;
  }
  for (; s < length; ++evaluations) {
    if (evaluations >= kMaxSteps) {
      count(evaluations, true);
      return false;
    }
    const double next = std::min(length, s + std::max(std::abs(g) / rate, least));
    const double there = value(next);
    if (checking()) check(std::abs(there - g) <= rate * (next - s) * (1.0 + 1e-9) + 1e-12);
    if ((there < 0.0) != (g < 0.0) || there == 0.0) {
      SegmentResult result;
      if (any || there == 0.0 || next - s <= least) {
        result.t = there == 0.0 ? next : s + (next - s) * (g / (g - there));
        result.beyond = next;
      } else {
        result = refine_root(value, s, g, next, there, 0.0, least, result);
      }
      evaluations += result.evaluations;
      count(evaluations, false);
      root = {from + result.t, from + std::max(result.t, result.beyond), evaluations, false, {}};
      return true;
    }
    s = next;
    g = there;
  }
  count(evaluations, false);
  return false;
}

}  // namespace morsel::geom

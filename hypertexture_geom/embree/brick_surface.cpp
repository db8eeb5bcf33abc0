// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/brick_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace morsel::geom {
namespace {

// Clips [a, b] to the part of the ray within the box; false if nothing remains. `slack` is added on
// all sides. Comparisons are written so that NaN leaves nothing.
bool clip(const topology::Box& box, double slack, const RaySegment& ray, double& a, double& b) {
  for (int i = 0; i < 3; ++i) {
    const double lo = box.min[i] - slack - ray.origin[i];
    const double hi = box.max[i] + slack - ray.origin[i];
    if (ray.direction[i] == 0.0) {
      if (lo > 0.0 || hi < 0.0) return false;
      continue;
    }
    const double inverse = 1.0 / ray.direction[i];
    const double p = lo * inverse, q = hi * inverse;
    a = std::max(a, std::min(p, q));
    b = std::min(b, std::max(p, q));
  }
  return a < b;
}

bool is_valid(const RaySegment& ray) {
  const double sum = ray.origin.x + ray.origin.y + ray.origin.z + ray.direction.x +
                     ray.direction.y + ray.direction.z;
  return std::isfinite(sum) && ray.tnear < ray.tfar;
}

}  // namespace

RayStatistics& ray_statistics() {
  thread_local RayStatistics statistics;
  return statistics;
}

bool BrickSurface::search(std::uint32_t brick, const RaySegment& ray, bool any, Root& root) const {
  RayStatistics& statistics = ray_statistics();
  ++statistics.bricks;
  if (!is_valid(ray)) return false;
  const Brick& b = bricks_[brick];
  const topology::Box box = bricks_.box(b);
  double from = ray.tnear, to = ray.tfar;
  if (!clip(box, bricks_.slack(box), ray, from, to)) return false;
  const double length = to - from;
  const double speed = ray.direction.length();
  if (!(speed > 0.0) || !(length < std::numeric_limits<double>::infinity())) return false;

  // Along the brick's own stretch of the ray, so that a far origin costs no precision in F.
  const Imath::V3d entry = ray.origin + ray.direction * from;
  const topology::ScalarField& field = bricks_.field(b);
  const auto value = [&](double s) { return field.value(entry + ray.direction * s); };
  const bool strict = from == ray.tnear;
  const SegmentResult r = geom::first_root(value, length, bricks_.ray_bounds(b, ray.direction),
                                           tolerance_ / speed, strict, any);
  statistics.evaluations += static_cast<std::uint64_t>(r.evaluations);
  if (r.limit) {
    ++statistics.limits;
    limits_.fetch_add(1, std::memory_order_relaxed);
  }
  if (!r.hit) return false;
  if (any) return true;
  root.t = from + r.t;
  root.beyond = std::max(root.t, from + r.beyond);
  root.evaluations = r.evaluations;
  return root.t > ray.tnear && root.t < ray.tfar;
}

}  // namespace morsel::geom

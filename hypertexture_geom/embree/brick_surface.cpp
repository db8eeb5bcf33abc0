// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/brick_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hypertexture_geom/embree/model_solver.h"

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

void BrickSurface::count(int evaluations, bool limit) const {
  RayStatistics& statistics = ray_statistics();
  statistics.evaluations += static_cast<std::uint64_t>(evaluations);
  if (!limit) return;
  ++statistics.limits;
  limits_.fetch_add(1, std::memory_order_relaxed);
}

bool BrickSurface::search(std::uint32_t index, const RaySegment& ray, bool any, Root& root) const {
  ++ray_statistics().bricks;
  if (!is_valid(ray)) return false;
  const Brick& brick = bricks_[index];
  Stretch stretch{ray.tnear, ray.tfar, {}, ray.direction.length(), false};
  if (!clip(bricks_.surface_box(brick), bricks_.slack(brick), ray, stretch.from, stretch.to))
    return false;
  if (!(stretch.speed > 0.0) ||
      !(stretch.to - stretch.from < std::numeric_limits<double>::infinity()))
    return false;
  stretch.entry = ray.origin + ray.direction * stretch.from;
  stretch.strict = stretch.from == ray.tnear;
  if (solver_ == Solver::kModel) {
    if (!by_model(brick, ray, stretch, any, root)) return false;
  } else {
    if (!by_segment(index, ray, stretch, any, root)) return false;
  }
  return any || (root.t > ray.tnear && root.t < ray.tfar);
}

bool BrickSurface::by_segment(std::uint32_t index, const RaySegment& ray, const Stretch& stretch,
                              bool any, Root& root) const {
  const topology::ScalarField& field = bricks_.field(bricks_[index]);
  const auto value = [&](double s) { return field.value(stretch.entry + ray.direction * s); };
  const SegmentResult r =
      geom::first_root(value, stretch.to - stretch.from, bricks_.ray_bounds(index, ray.direction),
                       tolerance_ / stretch.speed, stretch.strict, any);
  count(r.evaluations, r.limit);
  if (!r.hit) return false;
  root.t = stretch.from + r.t;
  root.beyond = std::max(root.t, stretch.from + r.beyond);
  root.evaluations = r.evaluations;
  root.has_gradient = false;
  return true;
}

bool BrickSurface::by_model(const Brick& b, const RaySegment& ray, const Stretch& stretch, bool any,
                            Root& root) const {
  const topology::Box box = bricks_.box(b);
  const Imath::V3d step = ray.direction * (stretch.to - stretch.from);
  float local_start[3], local_step[3], sum = 0.0f;
  for (int i = 0; i < 3; ++i) {
    const double scale = 2.0 / (box.max[i] - box.min[i]);
    local_start[i] = static_cast<float>((stretch.entry[i] - box.min[i]) * scale - 1.0);
    local_step[i] = static_cast<float>(step[i] * scale);
    sum += std::abs(local_step[i]);
  }
  const RayCubic p = restrict_to_ray(b.c, local_start, local_step);
  if (p.least() > b.value_error || p.greatest() < -b.value_error) return false;

  const RayCubicError error{b.value_error, b.gradient_error * sum + 6.0f * b.rounding,
                            b.hessian_error * sum * sum + 24.0f * b.rounding};
  const topology::ScalarField& field = bricks_.field(b);
  const auto value = [&](double s) { return field.value(stretch.entry + step * s); };
  const auto jet = [&](double s, double& slope) {
    const topology::Jet j = field.jet(stretch.entry + step * s);
    slope = j.gradient.dot(step);
    return j;
  };
  const double length = (stretch.to - stretch.from) * stretch.speed;
  const ModelSolver solver(value, jet, error, step, tolerance_ / length);
  const ModelResult r = solver.solve(p, stretch.strict, any);
  count(r.evaluations, r.limit);
  if (!r.hit) return false;
  root.t = stretch.from + r.s * (stretch.to - stretch.from);
  root.beyond = std::max(root.t, stretch.from + r.beyond * (stretch.to - stretch.from));
  root.evaluations = r.evaluations;
  root.has_gradient = r.has_gradient;
  root.gradient = r.gradient;
  return true;
}

}  // namespace morsel::geom

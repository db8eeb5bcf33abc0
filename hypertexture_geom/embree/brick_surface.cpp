// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/brick_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hypertexture_geom/embree/model_solver.h"

namespace morsel::geom {
namespace {

// What evaluations of F may differ by from F when bounds are checked, absolute.
constexpr double kRounding = 1e-12;

}  // namespace

const CompiledField<double>* BrickSurface::field_at(std::uint32_t index,
                                                    const Imath::V3d& x) const {
  const Brick& brick = bricks_[index];
  topology::Box box = bricks_.box(brick);
  box.min -= Imath::V3d(bricks_.margin());
  box.max += Imath::V3d(bricks_.margin());
  return box.intersects(x) ? &bricks_.field(brick) : nullptr;
}

double BrickSurface::value_at(std::uint32_t index, const Imath::V3d& x) const {
  const CompiledField<double>* field = field_at(index, x);
  return field != nullptr ? field->value(x - field->centre()) : whole_.value(x);
}

double BrickSurface::value_and_gradient_at(std::uint32_t index, const Imath::V3d& x,
                                           Imath::V3d& gradient) const {
  if (const CompiledField<double>* field = field_at(index, x))
    return field->value_and_gradient(x - field->centre(), gradient);
  const topology::Jet jet = whole_.jet(x);
  gradient = jet.gradient;
  return jet.value;
}

bool BrickSurface::search(std::uint32_t index, const RaySegment& ray, bool any, Root& root) const {
  ++ray_statistics().bricks;
  if (!is_valid(ray)) return false;
  const Brick& brick = bricks_[index];
  __builtin_prefetch(&brick);  // the cubic; what follows touches the other cache line first
  Stretch stretch{ray.tnear, ray.tfar, {}, ray.direction.length(), false};
  if (!clip(bricks_.surface_box(brick), bricks_.slack(brick), ray, stretch.from, stretch.to))
    return false;
  if (!(stretch.speed > 0.0) ||
      !(stretch.to - stretch.from < std::numeric_limits<double>::infinity()))
    return false;
  stretch.entry = ray.origin + ray.direction * stretch.from;
  stretch.strict = stretch.from == ray.tnear;
  return bricks_.has_slope_ranges() ? by_segment(index, ray, stretch, any, root)
                                    : by_model(brick, ray, stretch, any, root);
}

bool BrickSurface::by_segment(std::uint32_t index, const RaySegment& ray, const Stretch& stretch,
                              bool any, Root& root) const {
  const CompiledField<double>& field = bricks_.field(bricks_[index]);
  const Imath::V3d entry = stretch.entry - field.centre();
  const RayBounds bounds = bricks_.ray_bounds(index, ray.direction);
  double s_before = 0.0, g_before = 0.0;  // for the debug mode
  bool has_before = false;
  const auto value = [&](double s) {
    const double g = field.value(entry + ray.direction * s);
    if (checking()) {
      const double ds = s - s_before, p = bounds.slope_lo * ds, q = bounds.slope_hi * ds;
      const double dg = g - g_before;
      if (has_before) check(dg >= std::min(p, q) - kRounding && dg <= std::max(p, q) + kRounding);
      s_before = s;
      g_before = g;
      has_before = true;
    }
    return g;
  };
  const SegmentResult r = geom::first_root(value, stretch.to - stretch.from, bounds,
                                           tolerance() / stretch.speed, stretch.strict, any);
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
  const Imath::V3d step = ray.direction * (stretch.to - stretch.from);
  const Imath::V3d& scale = bricks_.scale(b.depth);
  const Imath::V3d start = (stretch.entry - bricks_.lower_corner(b)) * scale - Imath::V3d(1.0);
  const Imath::V3d local = step * scale;
  const float local_start[3] = {static_cast<float>(start.x), static_cast<float>(start.y),
                                static_cast<float>(start.z)};
  const float local_step[3] = {static_cast<float>(local.x), static_cast<float>(local.y),
                               static_cast<float>(local.z)};
  const float sum = std::abs(local_step[0]) + std::abs(local_step[1]) + std::abs(local_step[2]);
  const RayCubic p = restrict_to_ray(b.c, local_start, local_step);
  if (p.least() > b.value_error || p.greatest() < -b.value_error) return false;

  const RayCubicError error{b.value_error, b.gradient_error * sum + kSlopeRounding * b.rounding,
                            b.hessian_error * sum * sum + kCurvatureRounding * b.rounding};
  const CompiledField<double>& field = bricks_.field(b);
  const Imath::V3d entry = stretch.entry - field.centre();
  const auto check_value = [&](double s, double g) {
    const auto model = static_cast<double>(p.value(static_cast<float>(s)));
    check(std::abs(g - model) <= static_cast<double>(error.value) + kRounding);
  };
  const auto value = [&](double s) {
    const double g = field.value(entry + step * s);
    if (checking()) check_value(s, g);
    return g;
  };
  const auto with_gradient = [&](double s, Imath::V3d& gradient, double& slope) {
    const double g = field.value_and_gradient(entry + step * s, gradient);
    slope = gradient.dot(step);
    if (checking()) {
      check_value(s, g);
      const auto model = static_cast<double>(p.slope(static_cast<float>(s)));
      check(std::abs(slope - model) <= static_cast<double>(error.slope) + kRounding);
    }
    return g;
  };
  const double length = (stretch.to - stretch.from) * stretch.speed;
  const ModelSolver solver(value, with_gradient, error, tolerance() / length);
  const ModelResult r = solver.solve(p, stretch.strict, any);
  count(r.evaluations, r.limit);
  if (!r.hit) return false;
  root.t = stretch.from + r.s * (stretch.to - stretch.from);
  root.beyond = std::max(root.t, stretch.from + r.beyond * (stretch.to - stretch.from));
  root.evaluations = r.evaluations;
  root.has_gradient = r.has_gradient;
  if (!r.has_gradient || any) return true;
  // From the place of the last evaluation on to the root the gradient changes by as little as the
  // cubic's.
  const Imath::V3d change = cubic_gradient_change(
      b.c, local_start, local_step, static_cast<float>(r.gradient_at), static_cast<float>(r.s));
  root.gradient = r.gradient + change * scale;
  return true;
}

}  // namespace morsel::geom

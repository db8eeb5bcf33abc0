// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/density_capsule.h"

#include <limits>

#include "hypertexture_geom/field/excess.h"

namespace morsel::geom {
namespace {

struct Capsule {
  Imath::V3d axis, centre;
  double half, radius, smoothing, norm;  // norm: sqrt(1 + t^2)
  SumOfSquares squares;                  // w^2 + (t u)^2 + smoothing^2

  template <class Scope>
  auto operator()(const Scope& at) const {
    const auto beyond = squared_excess(at, axis, centre, half, smoothing);
    const auto distance = root(add(beyond, at.squares(squares)), squares.constant);
    return scale(add_constant(scale(distance, -1.0), radius), 1.0 / norm);
  }

  topology::Interval range() const {
    return {-std::numeric_limits<double>::infinity(), (radius - smoothing) / norm};
  }

  // e(u) >= |u| - half, so the distance from the segment is at most radius - norm level.
  std::optional<topology::Box> superlevel_box(double level) const {
    const double reach = radius - norm * level;
    if (reach < smoothing) return topology::Box();
    Imath::V3d extent;
    for (int i = 0; i < 3; ++i) extent[i] = half * std::abs(axis[i]) + reach;
    return box_about(centre, extent);
  }
};

}  // namespace

std::unique_ptr<Expression> make_capsule(const Imath::V3d& a, const Imath::V3d& b, double radius,
                                         double smoothing, double crown) {
  Capsule c;
  c.axis = (b - a).normalized();
  c.centre = (a + b) * 0.5;
  c.half = (b - a).length() * 0.5;
  c.radius = radius;
  c.smoothing = smoothing;
  const double t = crown * radius / (c.half + radius);
  c.norm = std::sqrt(1.0 + t * t);
  const Perpendiculars p = perpendiculars(c.axis);
  c.squares = {c.centre, smoothing * smoothing, {p.u, p.v, c.axis * t}};
  return std::make_unique<FormulaDensity<Capsule>>(c);
}

}  // namespace morsel::geom

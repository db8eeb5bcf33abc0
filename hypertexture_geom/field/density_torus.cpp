// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/density_torus.h"

#include <limits>

#include "hypertexture_geom/field/formula.h"

namespace morsel::geom {
namespace {

struct Torus {
  Imath::V3d axis;
  double major, minor, smoothing;
  SumOfSquares across, along;  // w^2 + s^2 and h^2 + s^2

  template <class Scope>
  auto operator()(const Scope& at) const {
    const auto rho = root(at.squares(across), across.constant);
    const auto tube = add(square(add_constant(rho, -major)), at.squares(along));
    return add_constant(scale(root(tube, along.constant), -1.0), minor);
  }

  topology::Interval range() const {
    return {-std::numeric_limits<double>::infinity(), minor - smoothing};
  }

  // A point of the torus is within `reach` of (rho - major, h) = (0, 0), and w <= rho.
  std::optional<topology::Box> superlevel_box(double level) const {
    const double reach = minor - level;
    if (reach < smoothing) return topology::Box();
    Imath::V3d extent;
    for (int i = 0; i < 3; ++i)
      extent[i] = major * std::sqrt(std::max(0.0, 1.0 - axis[i] * axis[i])) + reach;
    return box_about(across.origin, extent);
  }
};

}  // namespace

std::unique_ptr<Expression> make_torus(const Imath::V3d& centre, const Imath::V3d& axis,
                                       double major, double minor, double smoothing) {
  Torus t;
  t.axis = axis.normalized();
  t.major = major;
  t.minor = minor;
  t.smoothing = smoothing;
  const Perpendiculars p = perpendiculars(t.axis);
  t.across = {centre, smoothing * smoothing, {p.u, p.v, Imath::V3d(0.0)}};
  t.along = {centre, smoothing * smoothing, {t.axis, Imath::V3d(0.0), Imath::V3d(0.0)}};
  return std::make_unique<FormulaDensity<Torus>>(t);
}

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/density_rounded_box.h"

#include <limits>

#include "hypertexture_geom/field/excess.h"

namespace morsel::geom {
namespace {

struct RoundedBox {
  Imath::V3d inner;                  // half sizes less the rounding
  double rounding, smoothing, norm;  // norm: sqrt(1 + crown^2)
  SumOfSquares squares;              // sum (t_i u_i)^2 + smoothing^2

  template <class Scope>
  auto operator()(const Scope& at) const {
    auto sum = at.squares(squares);
    for (int i = 0; i < 3; ++i) {
      Imath::V3d axis(0.0);
      axis[i] = 1.0;
      sum = add(sum, squared_excess(at, axis, squares.origin, inner[i], smoothing));
    }
    return scale(add_constant(scale(root(sum, squares.constant), -1.0), rounding), 1.0 / norm);
  }

  topology::Interval range() const {
    return {-std::numeric_limits<double>::infinity(), (rounding - smoothing) / norm};
  }

  // e_i(u) >= |u| - inner_i.
  std::optional<topology::Box> superlevel_box(double level) const {
    const double reach = rounding - norm * level;
    if (reach < smoothing) return topology::Box();
    return box_about(squares.origin, inner + Imath::V3d(reach));
  }
};

}  // namespace

std::unique_ptr<Expression> make_rounded_box(const Imath::V3d& centre, const Imath::V3d& half_size,
                                             double rounding, double smoothing, double crown) {
  RoundedBox b;
  b.inner = half_size - Imath::V3d(rounding);
  b.rounding = rounding;
  b.smoothing = smoothing;
  b.norm = std::sqrt(1.0 + crown * crown);
  b.squares.origin = centre;
  b.squares.constant = smoothing * smoothing;
  for (int i = 0; i < 3; ++i) b.squares.rows[i][i] = crown * rounding / half_size[i];
  return std::make_unique<FormulaDensity<RoundedBox>>(b);
}

}  // namespace morsel::geom

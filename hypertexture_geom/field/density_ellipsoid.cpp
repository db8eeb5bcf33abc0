// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/density_ellipsoid.h"

#include <algorithm>
#include <limits>

#include "hypertexture_geom/field/formula.h"

namespace morsel::geom {
namespace {

struct Ellipsoid {
  Imath::V3d radii;
  double smallest, smoothing;
  SumOfSquares squares;

  template <class Scope>
  auto operator()(const Scope& at) const {
    return add_constant(scale(root(at.squares(squares), squares.constant), -1.0), smallest);
  }

  topology::Interval range() const {
    return {-std::numeric_limits<double>::infinity(), smallest - smoothing};
  }

  std::optional<topology::Box> superlevel_box(double level) const {
    if (level > smallest - smoothing) return topology::Box();
    return box_about(squares.origin, radii * ((smallest - level) / smallest));
  }
};

}  // namespace

std::unique_ptr<Expression> make_ellipsoid(const Imath::V3d& centre, const Imath::V3d& radii,
                                           double smoothing) {
  Ellipsoid e;
  e.radii = radii;
  e.smallest = std::min({radii.x, radii.y, radii.z});
  e.smoothing = smoothing;
  e.squares.origin = centre;
  e.squares.constant = smoothing * smoothing;
  for (int i = 0; i < 3; ++i) e.squares.rows[i][i] = e.smallest / radii[i];
  return std::make_unique<FormulaDensity<Ellipsoid>>(e);
}

}  // namespace morsel::geom

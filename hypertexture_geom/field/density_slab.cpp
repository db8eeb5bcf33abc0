// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/density_slab.h"

#include <limits>

#include "hypertexture_geom/field/formula.h"

namespace morsel::geom {
namespace {

struct Slab {
  Imath::V3d centre, axis;
  double half_thickness, smoothing;

  template <class Scope>
  auto operator()(const Scope& at) const {
    return add_constant(scale(smooth_distance(at, axis, centre, smoothing), -1.0),
                        half_thickness - smoothing);
  }

  topology::Interval range() const {
    return {-std::numeric_limits<double>::infinity(), half_thickness - smoothing};
  }

  std::optional<topology::Box> superlevel_box(double level) const {
    if (level > half_thickness - smoothing) return topology::Box();
    return std::nullopt;
  }
};

}  // namespace

std::unique_ptr<Expression> make_slab(const Imath::V3d& centre, const Imath::V3d& axis,
                                      double half_thickness, double smoothing) {
  return std::make_unique<FormulaDensity<Slab>>(
      Slab{centre, axis.normalized(), half_thickness, smoothing});
}

}  // namespace morsel::geom

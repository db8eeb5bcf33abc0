// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hypertexture_geom/field/expression.h"

namespace morsel::geom {

// D(x) = half_thickness - sqrt(u^2 + smoothing^2), u the distance from the plane through `centre`
// at right angles to `axis` (not zero; its length does not matter). Unbounded, so that the scene
// has to say in which box to work. Lipschitz constant 1. The faces lie smoothing^2 / (2
// half_thickness) inside. Requires 0 < smoothing < half_thickness.
std::unique_ptr<Expression> make_slab(const Imath::V3d& centre, const Imath::V3d& axis,
                                      double half_thickness, double smoothing);

}  // namespace morsel::geom

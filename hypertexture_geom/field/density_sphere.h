// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hypertexture_geom/field/expression.h"

namespace morsel::geom {

// D(x) = radius - sqrt(|x - centre|^2 + smoothing^2): the sphere of the paper's equation (3), its
// apex rounded so that D is smooth everywhere. Lipschitz constant 1. The surface D = 0 lies
// smoothing^2 / (2 radius) inside the radius.
std::unique_ptr<Expression> make_sphere(const Imath::V3d& centre, double radius, double smoothing);

}  // namespace morsel::geom

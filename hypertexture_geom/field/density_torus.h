// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hypertexture_geom/field/expression.h"

namespace morsel::geom {

// D(x) = minor - sqrt((rho - major)^2 + h^2 + s^2), rho = sqrt(w^2 + s^2), where h is the height
// along `axis` (not zero; its length does not matter) above the plane through `centre`, w the
// distance from the axis and s the smoothing, which rounds the core circle and the axis. Lipschitz
// constant 1. Requires 0 < s < minor.
std::unique_ptr<Expression> make_torus(const Imath::V3d& centre, const Imath::V3d& axis,
                                       double major, double minor, double smoothing);

}  // namespace morsel::geom

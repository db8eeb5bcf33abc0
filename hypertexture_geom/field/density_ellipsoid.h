// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hypertexture_geom/field/expression.h"

namespace morsel::geom {

// D(x) = m - sqrt(sum_i (m d_i / r_i)^2 + smoothing^2), d = x - centre, m the smallest radius.
// Lipschitz constant 1, reached along the axes of the smallest radius; along an axis of radius r
// the slope is m / r. The surface D = 0 lies inside the ellipsoid by r_i smoothing^2 / (2 m^2) on
// axis i. Requires radii > 0 and 0 < smoothing < m.
std::unique_ptr<Expression> make_ellipsoid(const Imath::V3d& centre, const Imath::V3d& radii,
                                           double smoothing);

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hypertexture_geom/field/expression.h"

namespace morsel::geom {

// A segment from `a` to `b` (not equal) with a radius. With the half length L, u the position along
// the segment from its middle, w the distance from its line, the excess e(u) of excess.h with k =
// smoothing, and t = crown radius / (L + radius):
//   D(x) = (radius - sqrt(w^2 + e(u)^2 + (t u)^2 + smoothing^2)) / sqrt(1 + t^2).
// The crown makes D strictly concave along the segment, where all points would else be maxima; it
// thins the ends by up to about crown^2 radius / 2. Lipschitz constant 1. Requires 0 < smoothing <
// radius / 2 and crown >= 0.
std::unique_ptr<Expression> make_capsule(const Imath::V3d& a, const Imath::V3d& b, double radius,
                                         double smoothing, double crown);

}  // namespace morsel::geom

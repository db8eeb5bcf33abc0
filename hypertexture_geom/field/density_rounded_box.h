// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hypertexture_geom/field/expression.h"

namespace morsel::geom {

// A box with rounded edges and corners. With u = x - centre, the excesses e_i(u_i) of excess.h over
// the inner half sizes half_i - rounding with k = smoothing, and t_i = crown rounding / half_i:
//   D(x) = (rounding - sqrt(sum_i (e_i^2 + (t_i u_i)^2) + smoothing^2)) / sqrt(1 + crown^2).
// Analytic, faces, edges and corners included. The crown makes D strictly concave inside, where it
// would else be almost constant, and the faces slightly convex: they lie inside the box by about
// (smoothing^2 + crown^2 rounding^2) / (2 rounding) in the middle and up to three times that at the
// edges. Lipschitz constant 1. Requires 0 < rounding <= half_i, 0 < smoothing < rounding / 2, 0 <=
// crown <= 1.
std::unique_ptr<Expression> make_rounded_box(const Imath::V3d& centre, const Imath::V3d& half_size,
                                             double rounding, double smoothing, double crown);

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "hypertexture_geom/field/expression.h"

namespace morsel::geom {

// Smooth union, intersection and difference of densities, by the smooth maximum of width k > 0
//   smax(a, b) = (a + b + sqrt((a - b)^2 + k^2)) / 2
// and smin(a, b) = -smax(-a, -b): as smooth as what they join. Their gradients are means of the
// gradients of a and b, so the Lipschitz constant is the larger of the two. smax exceeds max(a, b)
// by at most k / 2 (where a = b), by about k^2 / (4 |a - b|) away from there: a union is inflated,
// an intersection or difference deflated by that much.

// The parts are joined in pairs, the pairs in pairs and so on, so that n parts inflate by at most
// ceil(log2 n) k / 2. Requires at least two parts.
std::unique_ptr<Expression> make_smooth_union(
    const std::vector<std::shared_ptr<const Expression>>& parts, double width);
std::unique_ptr<Expression> make_smooth_intersection(
    const std::vector<std::shared_ptr<const Expression>>& parts, double width);

// smin(a, -b): what of `a` lies outside of `b`.
std::unique_ptr<Expression> make_smooth_difference(std::shared_ptr<const Expression> a,
                                                   std::shared_ptr<const Expression> b,
                                                   double width);

}  // namespace morsel::geom

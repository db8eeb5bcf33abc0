// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/field/formula.h"

namespace morsel::geom {

// How far a point lies beyond the interval of half length `half` about `origin` along the unit
// vector `axis`, with u = axis . (x - origin):
//   e(u) = (sqrt((u - half)^2 + k^2) + sqrt((u + half)^2 + k^2)) / 2 - half,
// the mean of two hyperbolas. Analytic and strictly convex, with slope within (-1, 1), at least
// max(0, |u| - half), and above it by at most k: at |u| = half by about k / 2, elsewhere by about
// k^2 / (4 | |u| - half |).
template <class Scope>
auto excess(const Scope& at, const Imath::V3d& axis, const Imath::V3d& origin, double half,
            double k) {
  const auto u = at.linear(axis, origin);
  const auto hyperbolas =
      add(smooth_abs(add_constant(u, -half), k), smooth_abs(add_constant(u, half), k));
  return add_constant(scale(hyperbolas, 0.5), k - half);
}

// e(u)^2.
template <class Scope>
auto squared_excess(const Scope& at, const Imath::V3d& axis, const Imath::V3d& origin, double half,
                    double k) {
  return square(excess(at, axis, origin, half, k));
}

// The same as a local model, worked out in the one variable u.
topology::LocalModel squared_excess(const ModelScope& at, const Imath::V3d& axis,
                                    const Imath::V3d& origin, double half, double k);

}  // namespace morsel::geom

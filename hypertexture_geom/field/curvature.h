// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "topology/scalar_field.h"

namespace morsel::geom {

// How a level set of F bends at a point, in 1 / length. Positive where the solid F > 0 is convex: a
// ball of radius r has mean 1 / r and Gaussian 1 / r^2.
struct Curvature {
  double mean = 0.0;      // (k1 + k2) / 2
  double gaussian = 0.0;  // k1 k2

  // The principal curvatures k1 >= k2: mean +- sqrt(mean^2 - gaussian), the root taken as 0 where
  // rounding makes its argument negative.
  double largest() const;
  double smallest() const;
};

// Of the level set of F through the point that `jet` was taken at, with g = grad F and H = Hess F:
//   mean = (g^T H g - |g|^2 tr H) / (2 |g|^3),   gaussian = g^T adj(H) g / |g|^4
// (R. Goldman, "Curvature formulas for implicit curves and surfaces", Computer Aided Geometric
// Design 22 (2005), equations 4.1 and 4.2; the signs are for F that is positive inside). Both are 0
// where g is 0, as no tangent plane exists there.
Curvature curvature(const topology::Jet& jet);

}  // namespace morsel::geom

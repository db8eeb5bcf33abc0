// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace morsel::geom {

// max(0, q)^3 on an interval replaced by one cubic polynomial, expanded about q0:
// a[0] + a[1] e + a[2] e^2 + a[3] e^3 with e = q - q0. error[i] bounds the i-th derivative's
// distance on the interval.
struct CubicPiece {
  double a[4];
  double error[3];
};

// The best of: the cube itself, zero, and (where the interval crosses 0) a nearly minimax cubic
// from a table. Requires lo <= hi; q0 is usually, but need not be, within.
CubicPiece truncated_cube(double q0, double lo, double hi);

}  // namespace morsel::geom

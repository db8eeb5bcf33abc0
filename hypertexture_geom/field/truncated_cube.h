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

// The table behind it, for evaluators that work on several intervals at once: column i is for
// intervals [lo, hi] whose zero lies at the fraction (i + 0.5) / kSize, and gives, for the interval
// mapped to t in [0, 1], the cubic c[0] + c[1] t + ... and its errors; both scale with powers of
// the interval's size. -hi * below[i] is the lower end that puts the zero there, -lo * above[i] the
// upper.
struct TruncatedCubeTable {
  static constexpr int kSize = 128;
  double c[4][kSize];
  double error[3][kSize];
  double below[kSize], above[kSize];
};
const TruncatedCubeTable& truncated_cube_table();

}  // namespace morsel::geom

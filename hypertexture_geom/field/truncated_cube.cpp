// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/truncated_cube.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace morsel::geom {
namespace {

// A cubic p(t) = c0 + c1 t + c2 t^2 + c3 t^3 close to max(0, t - r)^3 on [0, 1].
struct Fit {
  double c[4];
  double error[3];
};

double knot_power(double t, double r, int n) { return t <= r ? 0.0 : std::pow(t - r, n); }

// Real roots in [lo, hi] of a + b t + c t^2, added to `out`.
void quadratic_roots(double a, double b, double c, double lo, double hi, std::array<double, 8>& out,
                     int& n) {
  const double disc = b * b - 4.0 * a * c;
  if (disc < 0.0) return;
  const double q = -0.5 * (b + std::copysign(std::sqrt(disc), b));
  for (const double t : {q != 0.0 ? a / q : lo, c != 0.0 ? q / c : lo})
    if (t > lo && t < hi) out[n++] = t;
}

// The gradient's error decides where a cell can stop, so the derivative is fitted (a quadratic, by
// Chebyshev projection, which is within a few per cent of minimax) and the constant is set to
// centre the value's error.
Fit fit(double r) {
  // Chebyshev coefficients of f(t) = 3 max(0, t - r)^2 on [0, 1], degree 2.
  constexpr int kNodes = 256;
  double b[3] = {};
  for (int i = 0; i < kNodes; ++i) {
    const double angle = std::numbers::pi * (i + 0.5) / kNodes;
    const double t = 0.5 + 0.5 * std::cos(angle);
    const double f = 3.0 * knot_power(t, r, 2);
    for (int k = 0; k < 3; ++k) b[k] += (k == 0 ? 1.0 : 2.0) / kNodes * f * std::cos(k * angle);
  }
  // p'(t) = b0 + b1 T1(x) + b2 T2(x), x = 2t - 1.
  Fit p{};
  p.c[1] = b[0] - b[1] + b[2];
  p.c[2] = (2.0 * b[1] - 8.0 * b[2]) / 2.0;
  p.c[3] = 8.0 * b[2] / 3.0;
  const auto value_error = [&](double t) {
    return p.c[0] + t * (p.c[1] + t * (p.c[2] + t * p.c[3])) - knot_power(t, r, 3);
  };
  const auto slope_error = [&](double t) {
    return p.c[1] + t * (2.0 * p.c[2] + t * 3.0 * p.c[3]) - 3.0 * knot_power(t, r, 2);
  };
  const auto bend_error = [&](double t) {
    return 2.0 * p.c[2] + 6.0 * p.c[3] * t - 6.0 * knot_power(t, r, 1);
  };
  // Extremes of the value's error: ends, knot, roots of the slope's error on both pieces. Extremes
  // of the slope's error: ends, knot, the vertices. The bend's error is linear on both pieces.
  std::array<double, 8> at{0.0, r, 1.0};
  int n = 3;
  quadratic_roots(p.c[1], 2.0 * p.c[2], 3.0 * p.c[3], 0.0, r, at, n);
  quadratic_roots(p.c[1] - 3.0 * r * r, 2.0 * p.c[2] + 6.0 * r, 3.0 * p.c[3] - 3.0, r, 1.0, at, n);
  double lo = value_error(at[0]), hi = lo;
  for (int i = 1; i < n; ++i) {
    lo = std::min(lo, value_error(at[i]));
    hi = std::max(hi, value_error(at[i]));
  }
  p.c[0] -= 0.5 * (lo + hi);
  // Generous against the rounding of this very computation.
  const auto safe = [](double e) { return e * (1.0 + 1e-9) + 1e-12; };
  p.error[0] = safe(0.5 * (hi - lo));
  double slope =
      std::max({std::abs(slope_error(0.0)), std::abs(slope_error(r)), std::abs(slope_error(1.0))});
  if (const double t = -p.c[2] / (3.0 * p.c[3]); t > 0.0 && t < r)
    slope = std::max(slope, std::abs(slope_error(t)));
  if (const double t = -(p.c[2] + 3.0 * r) / (3.0 * p.c[3] - 3.0); t > r && t < 1.0)
    slope = std::max(slope, std::abs(slope_error(t)));
  p.error[1] = safe(slope);
  p.error[2] = safe(
      std::max({std::abs(bend_error(0.0)), std::abs(bend_error(r)), std::abs(bend_error(1.0))}));
  return p;
}

}  // namespace

const TruncatedCubeTable& truncated_cube_table() {
  static const TruncatedCubeTable table = [] {
    TruncatedCubeTable t;
    for (int i = 0; i < TruncatedCubeTable::kSize; ++i) {
      const double knot = (i + 0.5) / TruncatedCubeTable::kSize;
      const Fit f = fit(knot);
      for (int k = 0; k < 4; ++k) t.c[k][i] = f.c[k];
      for (int k = 0; k < 3; ++k) t.error[k][i] = f.error[k];
      t.below[i] = knot / (1.0 - knot);
      t.above[i] = (1.0 - knot) / knot;
    }
    return t;
  }();
  return table;
}

CubicPiece truncated_cube(double q0, double lo, double hi) {
  if (hi <= 0.0) return {};
  CubicPiece cube{{q0 * q0 * q0, 3.0 * q0 * q0, 3.0 * q0, 1.0}, {0.0, 0.0, 0.0}};
  if (lo >= 0.0) return cube;
  // Take the table's interval of fixed shape that covers [lo, hi]: one end moves outward.
  const double r = -lo / (hi - lo);
  constexpr int kSize = TruncatedCubeTable::kSize;
  const int i = std::min(kSize - 1, static_cast<int>(r * kSize));
  const TruncatedCubeTable& table = truncated_cube_table();
  if ((i + 0.5) / kSize > r)
    lo = -hi * table.below[i];
  else
    hi = -lo * table.above[i];
  const double c[4] = {table.c[0][i], table.c[1][i], table.c[2][i], table.c[3][i]};
  const double size = (hi - lo) * (1.0 + 1e-14);
  const double t = (q0 - lo) / size, size2 = size * size, size3 = size2 * size;
  CubicPiece piece;
  piece.a[0] = size3 * (c[0] + t * (c[1] + t * (c[2] + t * c[3])));
  piece.a[1] = size2 * (c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]));
  piece.a[2] = size * (c[2] + t * 3.0 * c[3]);
  piece.a[3] = c[3];
  // 1e-9 relative in the table's errors covers the rounding of the interval's ends here.
  piece.error[0] = size3 * table.error[0][i];
  piece.error[1] = size2 * table.error[1][i];
  piece.error[2] = size * table.error[2][i];
  return piece;
}

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/tensor_model.h"

#include <algorithm>
#include <cmath>

namespace morsel::geom {
namespace {

using namespace topology::monomial;

constexpr int kTerms = Polynomial6::kTerms;
constexpr int kStride = Polynomial6::kStride;

// Largest absolute value on [-1, 1] of the m-th function of a basis, and of its first two
// derivatives.
struct Norms {
  double of[3][kTerms];
};

constexpr Norms kMonomialNorms{
    {{1, 1, 1, 1, 1, 1, 1}, {0, 1, 2, 3, 4, 5, 6}, {0, 0, 2, 6, 12, 20, 30}}};

// The basis that terms are dropped in. Its functions of degree 4 and more have the derivative of
// least maximum, m / 2^(m-2) T_(m-1), for it is the gradient that decides where an octree cell can
// stop; their constants centre the value:
//   p2 = v^2 - 1/2
//   p3 = v^3 - kCubic v
//   p4 = v^4 - 3/2 v^2 + 9/32               value 9/32
//   p5 = v^5 - 5/3 v^3 + 5/8 v              value 0.1540 (at v^2 = (2 - sqrt 2) / 4)
//   p6 = v^6 - 15/8 v^4 + 15/16 v^2 - kSix  value kSix (at v^2 = (5 - sqrt 5) / 8)
// p2 and p3 appear only in products with other variables, where value and slope both matter.
constexpr double kCubic = 1.25;
constexpr double kSix = 0.0707;
constexpr Norms kBasisNorms{{{1, 1, 0.5, 0.538, 9.0 / 32.0, 0.15399, 0.0708},
                             {0, 1, 2, 3 - kCubic, 1, 0.625, 0.375},
                             {0, 0, 2, 6, 9, 10, 9.375}}};

// Coefficients of powers of v to those of the basis, in place, for 8 polynomials side by side whose
// like terms are `step` apart; and back for terms up to the third.
void to_basis(double* c, std::ptrdiff_t step) {
  const auto at = [&](int m) { return c + m * step; };
  for (int k = 0; k < kStride; ++k) {
    const double c6 = at(6)[k], c5 = at(5)[k];
    const double c4 = at(4)[k] + 15.0 / 8.0 * c6;
    const double c3 = at(3)[k] + 5.0 / 3.0 * c5;
    const double c2 = at(2)[k] + 1.5 * c4 - 15.0 / 16.0 * c6;
    at(1)[k] += kCubic * c3 - 5.0 / 8.0 * c5;
    at(0)[k] += 0.5 * c2 - 9.0 / 32.0 * c4 + kSix * c6;
    at(2)[k] = c2;
    at(3)[k] = c3;
    at(4)[k] = c4;
  }
}

// sum |c_ijk| N_ijk for value, gradient and Hessian.
DerivativeBounds3 weigh(const double (&c)[kTerms][kTerms][kStride], const Norms& norms,
                        const Imath::V3d& scale) {
  // Contracted with the z norms, then y, then x; [n] counts derivatives.
  double z[3][kTerms][kTerms], y[6][kTerms];
  for (int i = 0; i < kTerms; ++i)
    for (int j = 0; j < kTerms; ++j) {
      double s0 = 0.0, s1 = 0.0, s2 = 0.0;
      for (int k = 0; k < kTerms; ++k) {
        const double a = std::abs(c[i][j][k]);
        s0 += a * norms.of[0][k];
        s1 += a * norms.of[1][k];
        s2 += a * norms.of[2][k];
      }
      z[0][i][j] = s0;
      z[1][i][j] = s1;
      z[2][i][j] = s2;
    }
  constexpr int kY[6] = {0, 1, 0, 2, 1, 0},
                kZ[6] = {0, 0, 1, 0, 1, 2};  // derivatives of a row of y
  for (int n = 0; n < 6; ++n)
    for (int i = 0; i < kTerms; ++i) {
      double s = 0.0;
      for (int j = 0; j < kTerms; ++j) s += norms.of[kY[n]][j] * z[kZ[n]][i][j];
      y[n][i] = s;
    }
  const auto total = [&](int dx, int row) {
    double s = 0.0;
    for (int i = 0; i < kTerms; ++i) s += norms.of[dx][i] * y[row][i];
    return s;
  };
  const double sx = 1.0 / scale.x, sy = 1.0 / scale.y, sz = 1.0 / scale.z;
  DerivativeBounds3 b;
  b.value = total(0, 0);
  b.gradient[0] = total(1, 0) * sx;
  b.gradient[1] = total(0, 1) * sy;
  b.gradient[2] = total(0, 2) * sz;
  b.hessian = std::max({total(2, 0) * sx * sx, total(0, 3) * sy * sy, total(0, 5) * sz * sz,
                        total(1, 1) * sx * sy, total(1, 2) * sx * sz, total(0, 4) * sy * sz});
  return b;
}

}  // namespace

void TensorPolynomial::add(const Polynomial6& x, const Plane& plane) {
  for (int i = 0; i < kTerms; ++i) {
    const double f = x.c[i];
    if (f == 0.0) continue;
    for (int j = 0; j < kTerms; ++j)
      for (int k = 0; k < kStride; ++k) c_[i][j].c[k] += f * plane[j].c[k];
  }
}

DerivativeBounds3 TensorPolynomial::bounds(const Imath::V3d& scale) const {
  double t[kTerms][kTerms][kStride];
  for (int i = 0; i < kTerms; ++i)
    for (int j = 0; j < kTerms; ++j) std::copy(c_[i][j].c, c_[i][j].c + kStride, t[i][j]);
  return weigh(t, kMonomialNorms, scale);
}

DerivativeBounds3 TensorPolynomial::economize(const Imath::V3d& scale,
                                              topology::LocalModel& model) const {
  double t[kTerms][kTerms][kStride];
  for (int i = 0; i < kTerms; ++i)
    for (int j = 0; j < kTerms; ++j) std::copy(c_[i][j].c, c_[i][j].c + kStride, t[i][j]);
  for (int j = 0; j < kTerms; ++j) to_basis(&t[0][j][0], std::ptrdiff_t{kTerms} * kStride);
  for (int i = 0; i < kTerms; ++i) to_basis(&t[i][0][0], kStride);
  for (auto& plane : t) {
    // Along z the terms are neighbours: turn the plane over, convert, turn back.
    double turned[kTerms][kStride] = {};
    for (int j = 0; j < kTerms; ++j)
      for (int k = 0; k < kTerms; ++k) turned[k][j] = plane[j][k];
    to_basis(&turned[0][0], kStride);
    for (int j = 0; j < kTerms; ++j)
      for (int k = 0; k < kTerms; ++k) plane[j][k] = turned[k][j];
  }
  // What is kept, taken out and written in powers of u: p2 and p3 lose their lower terms to those.
  const auto take = [&](int i, int j, int k) {
    const double v = t[i][j][k];
    t[i][j][k] = 0.0;
    return v;
  };
  auto& c = model.c;
  const double x = 1.0 / scale.x, y = 1.0 / scale.y, z = 1.0 / scale.z;
  const double t000 = take(0, 0, 0), t100 = take(1, 0, 0), t010 = take(0, 1, 0),
               t001 = take(0, 0, 1), t200 = take(2, 0, 0), t020 = take(0, 2, 0),
               t002 = take(0, 0, 2), t110 = take(1, 1, 0), t101 = take(1, 0, 1),
               t011 = take(0, 1, 1), t300 = take(3, 0, 0), t030 = take(0, 3, 0),
               t003 = take(0, 0, 3), t210 = take(2, 1, 0), t201 = take(2, 0, 1),
               t120 = take(1, 2, 0), t021 = take(0, 2, 1), t102 = take(1, 0, 2),
               t012 = take(0, 1, 2), t111 = take(1, 1, 1);
  c[k1] = t000 - 0.5 * (t200 + t020 + t002);
  c[kX] = (t100 - kCubic * t300 - 0.5 * (t120 + t102)) * x;
  c[kY] = (t010 - kCubic * t030 - 0.5 * (t210 + t012)) * y;
  c[kZ] = (t001 - kCubic * t003 - 0.5 * (t201 + t021)) * z;
  c[kXX] = t200 * x * x;
  c[kYY] = t020 * y * y;
  c[kZZ] = t002 * z * z;
  c[kXY] = t110 * x * y;
  c[kXZ] = t101 * x * z;
  c[kYZ] = t011 * y * z;
  c[kXXX] = t300 * x * x * x;
  c[kYYY] = t030 * y * y * y;
  c[kZZZ] = t003 * z * z * z;
  c[kXXY] = t210 * x * x * y;
  c[kXXZ] = t201 * x * x * z;
  c[kXYY] = t120 * x * y * y;
  c[kYYZ] = t021 * y * y * z;
  c[kXZZ] = t102 * x * z * z;
  c[kYZZ] = t012 * y * z * z;
  c[kXYZ] = t111 * x * y * z;
  return weigh(t, kBasisNorms, scale);
}

}  // namespace morsel::geom

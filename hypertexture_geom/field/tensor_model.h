// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "topology/local_model.h"

namespace morsel::geom {

// A function of one variable as a polynomial of degree at most 6 in v = u / scale on [-1, 1]; the
// eighth place is 0 and lets the compiler work on whole vectors.
struct Polynomial6 {
  static constexpr int kTerms = 7;
  static constexpr int kStride = 8;
  double c[kStride] = {};
};

// Bounds on a function and its derivatives up to the second: of one variable, or (gradient,
// Hessian) of three, where one number stands for the largest of the six second derivatives.
struct DerivativeBounds1 {
  double d[3] = {};
};
struct DerivativeBounds3 {
  double value = 0.0;
  double gradient[3] = {};
  double hessian = 0.0;
};

// A polynomial of degree at most 6 in each of v_i = u_i / scale_i on [-1, 1]^3:
// sum c[i][j][k] v_x^i v_y^j v_z^k.
class TensorPolynomial {
 public:
  using Plane = std::array<Polynomial6, Polynomial6::kTerms>;  // powers of v_y, then of v_z

  // Adds X(v_x) * plane(v_y, v_z).
  void add(const Polynomial6& x, const Plane& plane);

  // Sums of absolute terms: bounds on the polynomial and its derivatives with respect to u.
  DerivativeBounds3 bounds(const Imath::V3d& scale) const;

  // Replaces it by a cubic polynomial in u, written to `model.c`, and returns bounds on what is
  // lost. Terms of degree 4 and more are economized as Chebyshev taught: each is replaced by the
  // combination of lower ones that leaves least. Rounding is the caller's.
  DerivativeBounds3 economize(const Imath::V3d& scale, topology::LocalModel& model) const;

 private:
  std::array<Plane, Polynomial6::kTerms> c_{};
};

}  // namespace morsel::geom

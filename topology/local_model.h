// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <array>

#include "topology/box.h"
#include "topology/interval.h"

namespace morsel::topology {

// Positions of the monomials of a cubic polynomial in u = x - centre, in the order
// 1, x, y, z, xx, yy, zz, xy, xz, yz, xxx, yyy, zzz, xxy, xxz, xyy, yyz, xzz, yzz, xyz.
namespace monomial {
enum : int {
  k1,
  kX,
  kY,
  kZ,
  kXX,
  kYY,
  kZZ,
  kXY,
  kXZ,
  kYZ,
  kXXX,
  kYYY,
  kZZZ,
  kXXY,
  kXXZ,
  kXYY,
  kYYZ,
  kXZZ,
  kYZZ,
  kXYZ
};
inline constexpr int kCount = 20;
}  // namespace monomial

// A cubic polynomial P in u = x - centre on the box |u_i| <= half_i, with rigorous bounds
//   |F - P| <= value_error,  |dF/dx_i - dP/dx_i| <= gradient_error[i],
//   |d2F/dx_i dx_j - d2P/dx_i dx_j| <= hessian_error   (every i, j)
// everywhere on that box. Errors include the rounding of the coefficients and of anything that this
// class computes from them: ranges returned here are enclosures of F's true ranges. A model that
// nothing is known of has infinite errors.
struct LocalModel {
  Imath::V3d centre{0.0};
  Imath::V3d half{0.0};
  std::array<double, monomial::kCount> c{};
  double value_error = 0.0;
  Imath::V3d gradient_error{0.0};
  double hessian_error = 0.0;

  // To be called once by whoever filled in the coefficients and their errors: adds what the
  // rounding of this class's own arithmetic (ranges, faces) can amount to, so that it needn't be
  // tracked again.
  void add_rounding();

  // P and grad P at `u` = x - centre (plain floating point, no enclosure).
  double value_at(const Imath::V3d& u) const;
  Imath::V3d gradient_at(const Imath::V3d& u) const;

  // Enclosures of F, of dF/dx_axis and of d2F/dx_i dx_j on the box.
  Interval range() const;
  Interval gradient_range(int axis) const;
  Interval hessian_range(int i, int j) const;

  // The enclosure of F that takes every monomial by itself: cheaper and wider than range().
  Interval plain_range() const;

  // The enclosure of F by the polynomial's Bernstein coefficients; tighter, about 400 operations.
  Interval bernstein_range() const;

  // The same F on the face at centre_axis + side * half_axis (side is -1 or +1): the centre moves
  // to the face and the face has no extent along the axis.
  LocalModel on_face(int axis, int side) const;
};

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include "topology/local_model.h"

namespace morsel::geom {

// The polynomial that RadialSum adds up, in u = x - centre: a cubic, |u|^2 u.T u with T symmetric,
// (v.u) |u|^4 and w |u|^6. A sum of cubes of q_i = q0_i + s_i |x - c_i|^2 is exactly of this form,
// whatever s_i and c_i are, and of any number of them; and about another centre it is again of this
// form. So where kernels are whole cubes, any number of impulses is these 30 numbers.
struct RadialPolynomial {
  Imath::V3d centre{0.0};
  double c[topology::monomial::kCount] = {};
  double form[6] = {};     // T: xx, yy, zz, xy, xz, yz
  double quintic[3] = {};  // v
  double sextic = 0.0;     // w
  // On the box that it was made for, of the value, of each first and of each second derivative: how
  // far it may be from what it stands for, and what a rounding of every coefficient is relative to
  // (bounds of the same polynomial, and of its derivatives, with absolute coefficients and |u|). A
  // box within that one has no larger ones, about its own centre.
  double error[3] = {};
  double size[3] = {};

  bool empty() const { return size[0] == 0.0; }
};

// The same function about another centre in the box that it was made for.
RadialPolynomial moved(const RadialPolynomial& polynomial, const Imath::V3d& centre);

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include "hypertexture_geom/field/radial_polynomial.h"
#include "topology/local_model.h"

namespace morsel::geom {

// g(u) = weight * phi(q(u)) with the quadratic form q = q0 + s (2 d.u + |u|^2), u = x - centre of
// the box: radial functions about a point at distance d from the centre, q being an affine function
// of the squared distance. phi is replaced by the cubic a[0] + a[1] e + a[2] e^2 + a[3] e^3, e = q
// - q0; on the box its value and its first and second derivatives (with respect to q) are off by at
// most error[0], error[1], error[2].
struct RadialTerm {
  Imath::V3d d;
  double s = 0.0;
  double weight = 1.0;
  double a[4] = {};
  double error[3] = {};
  double size = 0.0;      // a bound on |q| and of what q was computed from (1 + |s| maximal squared
                          // distance); for rounding
  double a_size[4] = {};  // bounds on |phi| and its first three derivatives' sizes, for rounding
};

// Sums radial terms into the cubic Taylor polynomial about the box's centre, with the error bounds
// of topology::LocalModel; rounding included.
class RadialSum {
 public:
  explicit RadialSum(const topology::Box& box);

  const Imath::V3d& centre() const { return model_.centre; }
  const Imath::V3d& half() const { return model_.half; }

  void add(const RadialTerm& term);
  // What is known on a box that contains this one.
  void add(const RadialPolynomial& polynomial);
  void add_constant(double value, double value_error = 0.0,
                    const Imath::V3d& gradient_error = Imath::V3d(0.0), double hessian_error = 0.0);

  topology::LocalModel finish();

  // The sum as it is, nothing dropped, instead of finish().
  RadialPolynomial polynomial() const;

 private:
  void fold_quartic();
  void fold_quintic_and_sextic();

  topology::LocalModel model_;
  // Degree 4: |u|^2 (quartic_ |u|^2 + u.T u) with T symmetric (xx, yy, zz, xy, xz, yz); degree 5:
  // (quintic_.u) |u|^4; degree 6: sextic_ |u|^6.
  double quartic_ = 0.0;
  double quartic_form_[6] = {};
  double quintic_[3] = {};
  double sextic_ = 0.0;
  double rounding_[3] = {};   // sums of term sizes: value, gradient, Hessian
  double inherited_[3] = {};  // of these, those of polynomials, whose own rounding is in the error
  int terms_ = 0;
};

}  // namespace morsel::geom

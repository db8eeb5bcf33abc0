// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "topology/local_model.h"

namespace morsel::geom {

// Bounds on |f|, its first derivatives (x, y, z) and its second ones (xx, yy, zz, xy, xz, yz) that
// hold everywhere on a box.
struct JetBound {
  std::array<double, 10> b{};

  JetBound& operator+=(const JetBound& other);
  JetBound& operator*=(double factor);  // factor >= 0
};
JetBound operator*(const JetBound& f, const JetBound& g);  // of the product f g

// A function on a local model's box as a polynomial of degree 4 plus a remainder with bounds: what
// products and compositions of local models are computed in. Coordinates are v = u / scale in
// [-1, 1], with scale >= half everywhere positive, so that a coefficient's size is what it
// contributes to the value, and boxes without extent along an axis need no special care.
class LocalSeries {
 public:
  // Monomials of degree at most 3 as in LocalModel, then those of degree 4.
  static constexpr int kCount = 35;

  explicit LocalSeries(const topology::LocalModel& model);

  const Imath::V3d& scale() const { return scale_; }
  double constant() const { return c_[0]; }
  // Drops the constant term: the function less constant(), exactly.
  void drop_constant() { c_[0] = 0.0; }

  LocalSeries& operator+=(const LocalSeries& other);  // on the same box
  LocalSeries& operator+=(double constant);
  LocalSeries& operator*=(double factor);
  friend LocalSeries operator*(const LocalSeries& f, const LocalSeries& g);

  // Adds a function of which only bounds (with respect to x, not v) are known.
  void add_remainder(double value, const Imath::V3d& gradient, const double (&hessian)[6]);

  // The cubic nearest to it. What can't be computed (overflow, infinite errors) comes out as
  // infinite errors, never as NaN.
  topology::LocalModel finish() const;

 private:
  LocalSeries(const Imath::V3d& centre, const Imath::V3d& half, const Imath::V3d& scale)
      : centre_(centre), half_(half), scale_(scale) {}

  // Of the terms of degrees `from` to `to`, with absolute coefficients.
  JetBound size(int from, int to) const;
  void round(double roundings, const JetBound& size);

  Imath::V3d centre_, half_, scale_;
  std::array<double, kCount> c_{};
  JetBound rest_;
};

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hypertexture_geom/field/impulse_list.h"
#include "topology/box.h"
#include "topology/interval.h"
#include "topology/local_model.h"

// Other ways to bound a noise of impulses on a box than the one that was built, made for comparing
// them (bench_forms.cpp). Bounds are those of exact arithmetic: unlike the library's they leave
// rounding out.
namespace morsel::geom::testing {

// Bounds of a function and of its slopes on a box.
struct Bounds {
  topology::Interval value, slope[3];
};

// What is made of an impulse whose border crosses the box.
enum class Border {
  kFit,      // the truncated power is replaced by a cubic fitted to it (as built)
  kNearest,  // by the power itself or by 0, whichever is nearer
};

// A polynomial of degree 6 in u = x - centre on |u_i| <= half_i, with bounds on what it leaves out.
class Sextic {
 public:
  Sextic(const Imath::V3d& centre, const Imath::V3d& half);

  void add(const topology::LocalModel& m);  // of the same box
  // weight * phi(q) for the impulse's q = 1 - inverse_square |x - impulse.centre|^2, phi being the
  // truncated cube, no term left out.
  void add(const Impulse& impulse, Border border);

  // Its terms up to degree 3, the others bounded by absolute values: Taylor's polynomial where the
  // impulses are all of the kind that is a polynomial on the box.
  topology::LocalModel truncated() const;
  // Ranges of the whole polynomial and of its derivatives by tensor Bernstein coefficients.
  Bounds bernstein() const;

 private:
  static constexpr int kDegree = 6, kSide = kDegree + 1;
  using Coefficients = std::vector<double>;  // of x^i y^j z^k at (i * kSide + j) * kSide + k
  static std::size_t at(int i, int j, int k) {
    return static_cast<std::size_t>((i * kSide + j) * kSide + k);
  }
  topology::Interval bernstein_range(const Coefficients& c, double error) const;

  Imath::V3d centre_, half_;
  Coefficients c_;
  double value_error_ = 0.0;
  Imath::V3d slope_error_{0.0};
};

// The library's form of model, for kernels max(0, 1 - r^2)^power, power 3 (C2) or 4 (C3).
topology::LocalModel radial_model(const ImpulseList& impulses, const topology::Box& box, int power,
                                  Border border);

// Value and gradient of weight * kernel, added.
void add_impulse(const Impulse& impulse, int power, const Imath::V3d& x, double& value,
                 Imath::V3d& gradient);

// Bounds of a model by three forms of ranges.
Bounds as_built(const topology::LocalModel& m);
Bounds by_monomials(const topology::LocalModel& m);  // each monomial by itself, squares aside
Bounds by_bernstein(const topology::LocalModel& m);

}  // namespace morsel::geom::testing

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "topology/scalar_field.h"

// Local models against the field itself: a bound that a sample point leaves is a wrong proof.
namespace morsel::geom::testing {

struct Outside {
  int value = 0, gradient = 0, hessian = 0, range = 0, face = 0;
  int undefined = 0;  // bounds that are NaN
  int infinite = 0;  // boxes on which the value has no bound, or a box no wider than `known` slopes
  int without_slopes = 0, boxes = 0;  // all boxes on which a slope has none, of how many
  double known = 0x1p-6;              // widest box on which slopes must have bounds
  int total() const { return value + gradient + hessian + range + face + undefined + infinite; }
  std::string text() const {
    return "value " + std::to_string(value) + ", gradient " + std::to_string(gradient) +
           ", Hessian " + std::to_string(hessian) + ", range " + std::to_string(range) + ", face " +
           std::to_string(face) + ", undefined " + std::to_string(undefined) + ", infinite " +
           std::to_string(infinite);
  }
};

inline double hessian_of(const topology::Jet& jet, int i, int j) {
  constexpr int kIndex[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  return jet.hessian[kIndex[i][j]];
}

inline double hessian_at(const topology::LocalModel& m, const Imath::V3d& u, int i, int j) {
  topology::LocalModel point = m;  // the polynomial alone: a box without extent about u
  for (int axis = 0; axis < 3; ++axis) {
    point.half = Imath::V3d(0.0);
    point.half[axis] = u[axis];
    point = point.on_face(axis, 1);
  }
  point.hessian_error = 0.0;
  point.half = Imath::V3d(0.0);
  return point.hessian_range(i, j).middle();
}

// Samples one box at corners and within. `scale` < 1 weakens the bounds, to show that the test
// would notice.
inline void add_outside(const topology::ScalarField& field, const topology::Box& box,
                        std::mt19937_64& random, int samples, double scale, Outside& outside) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Imath::V3d half = topology::half_size(box);
  const topology::LocalModel m = field.model(box);
  const auto local = field.restricted_to(box);
  const topology::Interval range = m.range();
  if (!(m.value_error >= 0.0) || !(m.hessian_error >= 0.0)) ++outside.undefined;
  for (int i = 0; i < 3; ++i)
    if (!(m.gradient_error[i] >= 0.0)) ++outside.undefined;
  ++outside.boxes;
  if (!std::isfinite(m.value_error)) ++outside.infinite;
  if (!std::isfinite(m.gradient_error.length2())) {
    ++outside.without_slopes;
    if (std::max({half.x, half.y, half.z}) <= 0.5 * outside.known) ++outside.infinite;
  }
  for (int k = 0; k < samples; ++k) {
    Imath::V3d u(unit(random), unit(random), unit(random));
    if (k < 8) u = Imath::V3d(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    Imath::V3d x = m.centre + u * half;
    for (int axis = 0; axis < 3; ++axis)
      x[axis] = std::clamp(x[axis], box.min[axis], box.max[axis]);
    u = x - m.centre;
    const topology::Jet jet = local->jet(x);
    // The jet's own rounding, far below what a wrong bound would show.
    const double slack = 1e-13 * (1.0 + std::abs(jet.value));
    if (!(std::abs(jet.value - m.value_at(u)) <= scale * m.value_error + slack)) ++outside.value;
    if (!(range.lo - slack <= jet.value && jet.value <= range.hi + slack)) ++outside.range;
    const Imath::V3d g = m.gradient_at(u);
    for (int axis = 0; axis < 3; ++axis) {
      const double loose = 1e-12 * (1.0 + std::abs(jet.gradient[axis]));
      if (!(std::abs(jet.gradient[axis] - g[axis]) <= scale * m.gradient_error[axis] + loose))
        ++outside.gradient;
      const topology::Interval slope = m.gradient_range(axis);
      if (!(slope.lo - loose <= jet.gradient[axis] && jet.gradient[axis] <= slope.hi + loose))
        ++outside.range;
      for (int j = 0; j <= axis; ++j)
        if (std::isfinite(m.hessian_error) &&
            !(std::abs(hessian_of(jet, axis, j) - hessian_at(m, u, axis, j)) <=
              scale * m.hessian_error + 1e-9 * (1.0 + m.hessian_error)))
          ++outside.hessian;
    }
    const int axis = static_cast<int>(random() % 3), side = random() % 2 ? 1 : -1;
    Imath::V3d y = x;
    y[axis] = side > 0 ? box.max[axis] : box.min[axis];
    const topology::Interval face = m.on_face(axis, side).range();
    const double at_face = local->value(y);
    if (!(face.lo - slack <= at_face && at_face <= face.hi + slack)) ++outside.face;
  }
}

// Samples random boxes with centres within `reach` of `about`, of widths 1/2 to 2^-20 of which some
// are flat, each as add_outside does.
inline Outside count_outside(const topology::ScalarField& field, std::mt19937_64& random, int boxes,
                             int samples, double scale = 1.0, double reach = 2.5,
                             const Imath::V3d& about = Imath::V3d(0.0)) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Outside outside;
  for (int n = 0; n < boxes; ++n) {
    const Imath::V3d c =
        about + Imath::V3d(reach * unit(random), reach * unit(random), reach * unit(random));
    const double width = std::ldexp(1.0, -1 - static_cast<int>(random() % 20));
    Imath::V3d half(width, width, width);
    if (n % 3 == 1)
      half *= Imath::V3d(std::abs(unit(random)), std::abs(unit(random)), std::abs(unit(random)));
    if (n % 5 == 1) half[static_cast<int>(random() % 3)] = 0.0;
    const topology::Box box(c - half, c + half);
    add_outside(field, box, random, samples, scale, outside);
  }
  return outside;
}

// Sets flush-to-zero and denormals-are-zero, as Embree wants them, for a scope.
class FlushToZero {
 public:
  explicit FlushToZero(bool on) : saved_(_mm_getcsr()) {
    if (on) _mm_setcsr(saved_ | 0x8040u);
  }
  ~FlushToZero() { _mm_setcsr(saved_); }

 private:
  unsigned saved_;
};

}  // namespace morsel::geom::testing

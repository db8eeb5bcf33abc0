// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/zero.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "topology/morse/classify.h"

namespace morsel::topology {
namespace {

constexpr int kNewtonSteps = 30;
constexpr double kTolerance = 1e-12;  // of the box's size: section 6 of the paper

double largest(const Imath::V3d& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

bool within(const Box& inner, const Box& outer) {
  for (int i = 0; i < 3; ++i)
    if (inner.min[i] < outer.min[i] || inner.max[i] > outer.max[i]) return false;
  return true;
}

// Contracts a box by the operator until it no longer shrinks.
Box contract(const ScalarField& field, Box box, std::uint64_t& models) {
  for (int i = 0; i < 60; ++i) {
    const Krawczyk k = krawczyk_on(field, box);
    models += 2;
    const double before = largest(box.max - box.min);
    box = k.enclosure;
    if (largest(box.max - box.min) > 0.5 * before) break;
  }
  return box;
}

}  // namespace

Krawczyk krawczyk_on(const ScalarField& field, const Box& box) {
  const LocalModel model = field.model(box);
  return krawczyk(model, gradient_at_centre(field.model(Box(model.centre, model.centre))));
}

std::optional<Imath::V3d> newton(const ScalarField& field, Imath::V3d x, const Box& bounds,
                                 int steps) {
  const double size = largest(bounds.max - bounds.min) + largest(bounds.min);
  double last = size;
  for (int i = 0; i < steps; ++i) {
    const Jet jet = field.jet(x);
    const double* h = jet.hessian;
    Eigen::Matrix3d m;
    m << h[0], h[3], h[4], h[3], h[1], h[5], h[4], h[5], h[2];
    const Eigen::Vector3d g(jet.gradient.x, jet.gradient.y, jet.gradient.z);
    const Eigen::Vector3d s = m.partialPivLu().solve(-g);
    if (!s.allFinite()) return std::nullopt;
    const Imath::V3d step(s[0], s[1], s[2]);
    x += step;
    if (!bounds.intersects(x)) return std::nullopt;
    const double length = largest(step);
    // Quadratic convergence: a step of the tolerance leaves an error far below it. Rounding ends
    // the descent as well.
    if (length <= kTolerance * size || (i > 3 && length <= 1e-9 * size && length >= last)) return x;
    last = length;
  }
  return std::nullopt;
}

CertifiedZero refine_zero(const ScalarField& field, const Box& unique, const Box& start,
                          std::uint64_t& models) {
  CertifiedZero zero;
  zero.unique = unique;
  bool enclosed = false;
  if (const auto x = newton(field, centre(start), unique, kNewtonSteps)) {
    const double size = largest(unique.max - unique.min) + largest(*x);
    for (double r = 1e-14 * size; r < 1e-4 * size && !enclosed; r *= 32.0) {
      const Box around(*x - Imath::V3d(r), *x + Imath::V3d(r));
      // Beyond `unique` the field need not be known.
      if (!within(around, unique)) break;
      const Krawczyk k = krawczyk_on(field, around);
      models += 2;
      if (k.zeros != ZeroCount::kOne || !within(k.enclosure, unique)) continue;
      zero.enclosure = k.enclosure;
      enclosed = true;
    }
  }
  if (!enclosed) zero.enclosure = contract(field, start, models);
  const LocalModel model = field.model(zero.enclosure);
  ++models;
  CriticalPoint& point = zero.point;
  point.position = centre(zero.enclosure);
  point.radius = 0.5 * largest(zero.enclosure.max - zero.enclosure.min) * (1.0 + 1e-12);
  const Jet jet = field.jet(point.position);
  const EigenSystem eigen = eigen_system(jet.hessian);
  point.value = jet.value;
  point.eigenvalues = eigen.values;
  point.axis = eigen.vectors[2];
  point.type = certified_type(model);
  return zero;
}

Sign sign_on(const ScalarField& field, const Box& box) {
  const Interval range = field.model(box).range();
  if (range.lo > 0.0) return Sign::kPositive;
  return range.hi < 0.0 ? Sign::kNegative : Sign::kUncertain;
}

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/lipschitz.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "topology/octree.h"

namespace morsel::geom {
namespace {

double bound_of(const topology::ScalarField& field, const topology::Box& box) {
  const topology::LocalModel model = field.model(box);
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double m = model.gradient_range(axis).magnitude();
    sum += m * m;
  }
  return std::sqrt(sum) * (1.0 + 1e-12);
}

// Greatest gradient at the centres of the cells of a level.
double sampled(const topology::ScalarField& field, const topology::Box& box, int depth) {
  const std::unique_ptr<topology::ScalarField> own = field.restricted_to(box);
  if (depth == 0) return own->jet(topology::centre(box)).gradient.length();
  std::array<double, 8> children;
  const auto visit = [&](int i) {
    children[static_cast<std::size_t>(i)] = sampled(*own, topology::child_box(box, i), depth - 1);
  };
  if (depth >= 3)
    tbb::parallel_for(0, 8, visit);
  else
    for (int i = 0; i < 8; ++i) visit(i);
  return *std::max_element(children.begin(), children.end());
}

// The bound on the box, subdivided until it is at most `wanted`, or max_depth is reached.
double refined(const topology::ScalarField& field, const topology::Box& box, double wanted,
               int max_depth) {
  const std::unique_ptr<topology::ScalarField> own = field.restricted_to(box);
  const double bound = bound_of(*own, box);
  if (bound <= wanted || max_depth == 0) return bound;
  std::array<double, 8> children;
  const auto visit = [&](int i) {
    children[static_cast<std::size_t>(i)] =
        refined(*own, topology::child_box(box, i), wanted, max_depth - 1);
  };
  if (max_depth >= 4)
    tbb::parallel_for(0, 8, visit);
  else
    for (int i = 0; i < 8; ++i) visit(i);
  return std::min(bound, *std::max_element(children.begin(), children.end()));
}

}  // namespace

double lipschitz_bound(const topology::ScalarField& field, const topology::Box& box,
                       int max_depth) {
  constexpr int kSampledDepth = 5;
  const double greatest = sampled(field, box, std::min(kSampledDepth, max_depth));
  return refined(field, box, 1.1 * greatest, max_depth);
}

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/lipschitz.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>

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

constexpr int kSampledDepth = 5;

// Bounds on boxes, subdivided until they are at most `wanted`, or as far as that helps.
class Refinement {
 public:
  Refinement(double wanted, int max_depth, const topology::Execution& execution)
      : wanted_(wanted), max_depth_(max_depth), execution_(execution) {}

  // `above` are the bounds of the parent and of its parent.
  double bound(const topology::ScalarField& field, const topology::Box& box, int depth,
               std::array<double, 2> above) {
    execution_.check_cancel();
    const std::unique_ptr<topology::ScalarField> own = field.restricted_to(box);
    const double bound_here = bound_of(*own, box);
    // Cells as small as those that were sampled are below the field's features: errors of models
    // that shrink at all shrink there.
    const bool stuck = depth > kSampledDepth && bound_here > kProgress * above[1];
    if (bound_here <= wanted_ || depth == max_depth_ || stuck) {
      report(depth);
      return bound_here;
    }
    std::array<double, 8> children;
    const auto visit = [&](int i) {
      children[static_cast<std::size_t>(i)] =
          bound(*own, topology::child_box(box, i), depth + 1, {bound_here, above[0]});
    };
    if (max_depth_ - depth >= 4)
      tbb::parallel_for(0, 8, visit);
    else
      for (int i = 0; i < 8; ++i) visit(i);
    return std::min(bound_here, *std::max_element(children.begin(), children.end()));
  }

 private:
  static constexpr double kProgress = 0.95;

  void report(int depth) {
    if (!execution_.progress) return;
    const std::lock_guard lock(mutex_);
    done_ += std::ldexp(1.0, -3 * depth);
    if (done_ < 1.0 && done_ - reported_ < 1.0 / 256.0) return;
    reported_ = done_;
    execution_.progress(done_, "slopes");
  }

  double wanted_;
  int max_depth_;
  const topology::Execution& execution_;
  std::mutex mutex_;
  double done_ = 0.0, reported_ = 0.0;  // shares of the volume
};

}  // namespace

double lipschitz_bound(const topology::ScalarField& field, const topology::Box& box,
                       const topology::Execution& execution, int max_depth) {
  const double greatest = sampled(field, box, std::min(kSampledDepth, max_depth));
  constexpr double kNone = std::numeric_limits<double>::infinity();
  return Refinement(1.1 * greatest, max_depth, execution).bound(field, box, 0, {kNone, kNone});
}

}  // namespace morsel::geom

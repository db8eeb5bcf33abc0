// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <atomic>
#include <cstdint>

#include "hypertexture_geom/embree/bricks.h"
#include "hypertexture_geom/embree/solver.h"

namespace morsel::geom {

// A piece of a ray: the points origin + t * direction with tnear < t < tfar. The direction may have
// any length and zero components; a ray with a NaN or infinity in it, or no direction, hits
// nothing.
struct RaySegment {
  Imath::V3d origin, direction;
  double tnear, tfar;
};

// What this thread's rays have cost since it started; take differences around a query.
struct RayStatistics {
  std::uint64_t bricks = 0;       // bricks that a ray was tested against
  std::uint64_t evaluations = 0;  // of F
  std::uint64_t limits = 0;       // tests that ended at the evaluation limit
};
RayStatistics& ray_statistics();

// Ray tests against one brick each; pure, no Embree.
class BrickSurface {
 public:
  // `tolerance` is the greatest error of a hit along the ray, as a length.
  BrickSurface(BrickSet bricks, double tolerance, Solver solver)
      : bricks_(std::move(bricks)), tolerance_(tolerance), solver_(solver) {}

  struct Root {
    double t;       // first root in (tnear, tfar)
    double beyond;  // where to go on for the next: pass it as tnear
    int evaluations;
    bool has_gradient = false;
    Imath::V3d gradient{0.0};  // of F at the root, if the search came by it
  };
  // The first root of F along the ray within the brick and its slack. Both directions of crossing
  // are roots. If F is 0 at tnear itself, that root is not in the open interval and is left out.
  bool first_root(std::uint32_t brick, const RaySegment& ray, Root& root) const {
    return search(brick, ray, false, root);
  }
  // Whether there is any; cheaper, as no root is refined.
  bool any_root(std::uint32_t brick, const RaySegment& ray) const {
    Root root;
    return search(brick, ray, true, root);
  }
  // Gradient of F at a root.
  Imath::V3d gradient(std::uint32_t brick, const RaySegment& ray, const Root& root) const {
    if (root.has_gradient) return root.gradient;
    return bricks_.field(bricks_[brick]).jet(ray.origin + ray.direction * root.t).gradient;
  }

  const BrickSet& bricks() const { return bricks_; }
  double tolerance() const { return tolerance_; }
  // Tests that ended at the evaluation limit, by all threads.
  std::uint64_t limits() const { return limits_.load(std::memory_order_relaxed); }

 private:
  // The ray's stretch within a brick.
  struct Stretch {
    double from, to;
    Imath::V3d entry;  // at `from`, so that a far origin costs no precision in F
    double speed;      // length of the direction
    bool strict;       // the ray starts there: a root at `from` is not a hit
  };
  bool search(std::uint32_t brick, const RaySegment& ray, bool any, Root& root) const;
  bool by_segment(std::uint32_t brick, const RaySegment& ray, const Stretch& stretch, bool any,
                  Root& root) const;
  bool by_model(const Brick& brick, const RaySegment& ray, const Stretch& stretch, bool any,
                Root& root) const;
  void count(int evaluations, bool limit) const;

  BrickSet bricks_;
  double tolerance_;
  Solver solver_;
  mutable std::atomic<std::uint64_t> limits_{0};
};

}  // namespace morsel::geom

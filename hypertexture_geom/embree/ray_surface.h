// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>

#include "hypertexture_geom/embree/membership_filter.h"
#include "topology/box.h"

namespace morsel::geom {

// A piece of a ray: the points origin + t * direction with tnear < t < tfar. The direction may have
// any length and zero components; a ray with a NaN or infinity in it, or no direction, hits
// nothing.
struct RaySegment {
  Imath::V3d origin, direction;
  double tnear, tfar;
};

// Clips [a, b] to the part of the ray within the box; false if nothing remains. `slack` is added on
// all sides. Comparisons are written so that NaN leaves nothing.
inline bool clip(const topology::Box& box, double slack, const RaySegment& ray, double& a,
                 double& b) {
  for (int i = 0; i < 3; ++i) {
    const double lo = box.min[i] - slack - ray.origin[i];
    const double hi = box.max[i] + slack - ray.origin[i];
    if (ray.direction[i] == 0.0) {
      if (lo > 0.0 || hi < 0.0) return false;
      continue;
    }
    const double inverse = 1.0 / ray.direction[i];
    const double p = lo * inverse, q = hi * inverse;
    a = std::max(a, std::min(p, q));
    b = std::min(b, std::max(p, q));
  }
  return a < b;
}

inline bool is_valid(const RaySegment& ray) {
  const double sum = ray.origin.x + ray.origin.y + ray.origin.z + ray.direction.x +
                     ray.direction.y + ray.direction.z;
  return std::isfinite(sum) && ray.tnear < ray.tfar;
}

// What this thread's rays have cost since it started; take differences around a query.
struct RayStatistics {
  std::uint64_t bricks = 0;       // primitives that a ray was tested against
  std::uint64_t evaluations = 0;  // of F
  std::uint64_t limits = 0;       // tests that ended at the evaluation limit
  std::uint64_t filtered = 0;     // roots that were put to the membership filter
};
RayStatistics& ray_statistics();

// Ray tests against one primitive each; pure, no Embree. What Embree's callbacks see of a solver.
class RaySurface {
 public:
  // `tolerance` is the greatest error of a hit along the ray, as a length.
  explicit RaySurface(double tolerance) : tolerance_(tolerance) {}
  virtual ~RaySurface() = default;

  struct Root {
    double t;       // first root in (tnear, tfar)
    double beyond;  // where to go on for the next: pass it as tnear
    int evaluations;
    bool has_gradient = false;
    Imath::V3d gradient{0.0};  // of F at the root, if the search came by it
  };

  virtual std::uint32_t size() const = 0;  // primitives
  // Holds all surface of the primitive.
  virtual topology::Box bounds(std::uint32_t primitive) const = 0;
  // The octree's cell that it is, if it is one; else as bounds.
  virtual topology::Box cell(std::uint32_t primitive) const { return bounds(primitive); }
  virtual std::uint64_t blocks() const { return 0; }  // restricted fields that primitives share
  virtual std::uint64_t bytes() const = 0;            // theirs included, the filter's not
  std::uint64_t filter_bytes() const { return filter_ ? filter_->bytes() : 0; }
  // Component of its surface; kNoComponent if that depends on the place.
  virtual std::uint32_t component(std::uint32_t primitive) const = 0;
  // F at `x`, which need not lie in the primitive: cheaper where it does.
  virtual double value_at(std::uint32_t primitive, const Imath::V3d& x) const = 0;
  virtual double value_and_gradient_at(std::uint32_t primitive, const Imath::V3d& x,
                                       Imath::V3d& gradient) const = 0;

  // The first root of F along the ray within the primitive, of a kept component. Both directions of
  // crossing are roots. If F is 0 at tnear itself, that root is not in the open interval and is
  // left out.
  bool first_root(std::uint32_t primitive, const RaySegment& ray, Root& root) const {
    if (!next_root(primitive, ray, root)) return false;
    return !is_mixed(primitive) || first_kept(primitive, ray, root);
  }
  // Whether there is any; cheaper, as no root is refined.
  bool any_root(std::uint32_t primitive, const RaySegment& ray) const {
    Root root;
    if (is_mixed(primitive)) return first_root(primitive, ray, root);
    return search(primitive, ray, true, root);
  }
  // Gradient of F at a root.
  Imath::V3d gradient(std::uint32_t primitive, const RaySegment& ray, const Root& root) const {
    if (root.has_gradient) return root.gradient;
    Imath::V3d gradient;
    value_and_gradient_at(primitive, ray.origin + ray.direction * root.t, gradient);
    return gradient;
  }
  // Component of the surface at `x` on the primitive.
  std::uint32_t component_at(std::uint32_t primitive, const Imath::V3d& x) const {
    const std::uint32_t known = component(primitive);
    return known == topology::kNoComponent && filter_ ? filter_->component_at(x) : known;
  }

  double tolerance() const { return tolerance_; }
  // Tests that ended at the evaluation limit, by all threads.
  std::uint64_t limits() const { return limits_.load(std::memory_order_relaxed); }

  // Which roots are put to the filter before they count. It also answers component_at.
  enum class Filtered {
    kNone,
    kMixed,  // those on primitives that may hold several components
    kAll,
  };
  void set_filter(std::shared_ptr<const MembershipFilter> filter, Filtered filtered) {
    filter_ = std::move(filter);
    filtered_ = filtered;
  }

  // Debug mode: every evaluation of F is compared with the bound that the solver relies on there.
  void check_bounds() { checking_ = true; }
  std::uint64_t violations() const { return violations_.load(std::memory_order_relaxed); }

 protected:
  // The first root, of any component and perhaps at an end of the interval or, by a rounding, just
  // before it. `any`: the root need not be refined.
  virtual bool search(std::uint32_t primitive, const RaySegment& ray, bool any,
                      Root& root) const = 0;
  virtual bool has_several(std::uint32_t primitive) const = 0;

  void count(int evaluations, bool limit) const {
    RayStatistics& statistics = ray_statistics();
    statistics.evaluations += static_cast<std::uint64_t>(evaluations);
    if (!limit) return;
    ++statistics.limits;
    limits_.fetch_add(1, std::memory_order_relaxed);
  }
  bool checking() const { return checking_; }
  void check(bool holds) const {
    if (!holds) violations_.fetch_add(1, std::memory_order_relaxed);
  }

 private:
  bool is_mixed(std::uint32_t primitive) const {
    return filtered_ != Filtered::kNone && (filtered_ == Filtered::kAll || has_several(primitive));
  }
  // The first root within the open interval, of any component.
  bool next_root(std::uint32_t primitive, const RaySegment& ray, Root& root) const {
    if (!search(primitive, ray, false, root)) return false;
    return root.t > ray.tnear ? root.t < ray.tfar : root_behind(primitive, ray, root);
  }
  // The same after search has given a root that is not behind tnear: one that was refused before
  // and is met again by a rounding.
  bool root_behind(std::uint32_t primitive, RaySegment ray, Root& root) const;
  bool first_kept(std::uint32_t primitive, RaySegment ray, Root& root) const;

  double tolerance_;
  bool checking_ = false;
  Filtered filtered_ = Filtered::kNone;
  std::shared_ptr<const MembershipFilter> filter_;
  mutable std::atomic<std::uint64_t> limits_{0}, violations_{0};
};

}  // namespace morsel::geom

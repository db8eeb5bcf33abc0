// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <memory>
#include <optional>

#include "hypertexture_geom/embree/compat.h"  // the only place that includes Embree's headers
#include "hypertexture_geom/field/field.h"
#include "topology/cache_file.h"

namespace morsel::geom {

struct GeometryOptions {
  topology::KeepRule keep;
};

// What a renderer needs to know of a hit, in object space.
struct ShadingPoint {
  Imath::V3f normal;        // unit, outward (-grad F), from the exact gradient
  Imath::V3f spawn_front;   // origins for rays that leave to the outside (F < 0 there, by evaluation) ...
  Imath::V3f spawn_behind;  // ... and to the inside (F > 0 there, by evaluation)
  std::uint32_t component = topology::kNoComponent;
};

struct GeometryStatistics {
  std::uint64_t bricks = 0;
  std::uint64_t bytes = 0;
};

// Hypertexture surface as Embree user geometry: one primitive a brick, a brick being a leaf of the labelled
// octree that holds surface of a kept component. Immutable after construction and shared by all instances.
class HypertextureGeometry {
 public:
  HypertextureGeometry(std::shared_ptr<const Field> field, std::shared_ptr<const topology::TopologyCache> cache,
                       const GeometryOptions& options);
  ~HypertextureGeometry();
  HypertextureGeometry(const HypertextureGeometry&) = delete;
  HypertextureGeometry& operator=(const HypertextureGeometry&) = delete;

  // A new user geometry on `device`, committed, with one reference that the caller releases. This object
  // must outlive it. A hit has primID = brick, u = v = 0, Ng = -grad F (outward), as Embree wants unnormalised.
  RTCGeometry create(RTCDevice device) const;

  // First hit of the ray with the kept surface inside one brick, t in (tnear, tfar); pure, no Embree.
  struct Hit {
    double t;
    Imath::V3d gradient;  // of F at the hit
    int evaluations;
  };
  std::optional<Hit> intersect_brick(std::uint32_t brick, const Imath::V3d& origin, const Imath::V3d& direction,
                                     double tnear, double tfar) const;

  // `point` is origin + t * direction of a hit on `brick`; `extra_error` is an absolute bound on the distance
  // of `point` from the true hit beyond its own rounding (e.g. from an instance's transform).
  ShadingPoint shade(std::uint32_t brick, const Imath::V3f& point, float extra_error = 0.0f) const;

  std::uint32_t component(std::uint32_t brick) const;
  std::uint32_t main_component() const;
  topology::Box bounds() const;  // of the bricks
  GeometryStatistics statistics() const;
  const Field& field() const;
  const topology::TopologyCache& cache() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace morsel::geom

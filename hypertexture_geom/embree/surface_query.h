// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "hypertexture_geom/embree/geometry.h"

namespace morsel::geom {

// Ray queries against one geometry by itself, in object space, with answers in double precision.
// For thickness, boolean operations, or tools that have no scene. Holds an Embree scene of its own
// (its hierarchy's memory comes again) and references to `device`; `geometry` must outlive it. All
// queries may be called from several threads at once.
//
// Rays are given in float because Embree culls in float. Direction may have any length. A ray that
// Embree does not take (see is_traceable) hits nothing.
class SurfaceQuery {
 public:
  // Throws std::runtime_error when Embree fails.
  SurfaceQuery(const HypertextureGeometry& geometry, RTCDevice device);
  ~SurfaceQuery();
  SurfaceQuery(const SurfaceQuery&) = delete;
  SurfaceQuery& operator=(const SurfaceQuery&) = delete;

  struct Hit {
    double t = 0.0;  // origin + t * direction
    std::uint32_t brick = 0;
    bool entering = false;     // F rises along the ray: from outside to inside
    Imath::V3d gradient{0.0};  // of F
  };

  // Every crossing with t in (tnear, tfar), by increasing t; each once, although bricks that share
  // a face may both find it. Crossings enter and leave in turn, unless the ray runs through
  // components that are not kept.
  std::vector<Hit> all_hits(const Imath::V3f& origin, const Imath::V3f& direction,
                            float tnear = 0.0f,
                            float tfar = std::numeric_limits<float>::infinity()) const;
  // The first of them.
  std::optional<Hit> first_hit(const Imath::V3f& origin, const Imath::V3f& direction,
                               float tnear = 0.0f,
                               float tfar = std::numeric_limits<float>::infinity()) const;
  // Whether there is any; stops at the first sign of one.
  bool any_hit(const Imath::V3f& origin, const Imath::V3f& direction, float tnear = 0.0f,
               float tfar = std::numeric_limits<float>::infinity()) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace morsel::geom

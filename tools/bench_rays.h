// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <string>
#include <vector>

#include "hypertexture_geom/embree/geometry.h"

namespace morsel::tools {

// Processor time of all threads of this process so far, in seconds: what other processes do on the
// machine matters less to it than to a clock.
double processor_seconds();

struct BenchRay {
  Imath::V3f origin, direction;
};

// Rays of one kind, in the order in which they are traced.
struct RaySet {
  std::string name;
  std::vector<BenchRay> rays;
  bool coherent = false;
  bool shadow = false;  // only whether something is hit is asked
};

// What tracing a set of rays took.
struct RayCost {
  std::uint64_t rays = 0, hits = 0;
  std::uint64_t bricks = 0;       // primitives of user geometry that were tested
  std::uint64_t evaluations = 0;  // of the field
  double seconds = 0.0;           // processor time

  double rays_per_second() const { return static_cast<double>(rays) / seconds; }
  double evaluations_per_ray() const {
    return static_cast<double>(evaluations) / static_cast<double>(rays);
  }
};

// Traces all rays, each by a call of its own, in the caller's TBB arena. `t`, if given, gets the
// hit distance of each ray (infinity: none).
RayCost trace(RTCScene scene, const RaySet& set, std::vector<float>* t = nullptr);

// A pinhole camera that frames the object, side x side pixels in tiles.
RaySet primary_rays(const topology::Box& bounds, int side);

// From the points where `primary` hits the surface, `offset` above it, in cosine-distributed
// directions and random order: for closest hits (incoherent) or for occlusion (shadow).
RaySet secondary_rays(const geom::HypertextureGeometry& geometry, RTCScene scene,
                      const RaySet& primary, double offset, bool shadow);

}  // namespace morsel::tools

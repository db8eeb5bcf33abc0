// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "renderer/accel/interaction.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// Ray queries against a scene: one Embree scene per geometry, instances of them, and the rectangle
// lights. Immutable; queries may come from any thread, which should have FlushDenormals set.
class SceneAccel {
 public:
  // Builds everything with the calling thread's TBB arena. `scene` must outlive this object. Throws
  // std::invalid_argument for indices out of range or transforms that cannot be used, and
  // std::runtime_error for errors of Embree.
  explicit SceneAccel(const Scene& scene);
  ~SceneAccel();
  SceneAccel(const SceneAccel&) = delete;
  SceneAccel& operator=(const SceneAccel&) = delete;

  // First hit with t > 0. `interaction` is written only if there is one.
  bool intersect(const Ray& ray, RayKind kind, SurfaceInteraction& interaction) const;
  // Whether something opaque that casts shadows is in the way.
  bool occluded(const Ray& ray) const;
  // Whether anything is there that shadow rays may pass in part: ask intersect() with kCutout.
  bool has_cutouts() const;
  // Whether rays can cost anything in hypertextures: see hypertexture_cost().
  bool has_hypertextures() const;

  struct Statistics {
    std::uint64_t triangles = 0;  // of meshes, instances not counted
    std::uint64_t hypertexture_bricks = 0;
    std::uint64_t bytes = 0;  // allocated by Embree
  };
  Statistics statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Of the Embree that this was built with, as "3.13.5".
const char* embree_version();

// What the calling thread's rays have cost in hypertextures since it started: evaluations of
// fields, roots put to membership filters. For differences around a query.
struct HypertextureCost {
  std::uint64_t evaluations = 0, filtered = 0;
};
HypertextureCost hypertexture_cost();

// Sets flush-to-zero and denormals-are-zero, which Embree wants in threads that trace, and restores
// the thread's mode at the end.
class FlushDenormals {
 public:
  FlushDenormals();
  ~FlushDenormals();
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned saved_;
};

}  // namespace morsel::render

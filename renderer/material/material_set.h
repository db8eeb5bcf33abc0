// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "renderer/accel/interaction.h"
#include "renderer/bsdf/surface_parameters.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// The materials of a scene, ready to be asked at hits: tables computed, textures open. Immutable.
class MaterialSet {
 public:
  // `scene` must outlive this object.
  explicit MaterialSet(const Scene& scene);

  // What the surface is at `hit`. Every alpha is at least `smallest_alpha`.
  SurfaceParameters parameters(const SurfaceInteraction& hit, float smallest_alpha = 0.0f) const;
  // Emitted radiance, the same on both sides and in all directions.
  V3f emission(const SurfaceInteraction& hit) const;
  bool emits(std::uint32_t material) const { return prepared_[material].emits; }
  // Share of rays that meet the surface at `hit`; the others pass as if it were not there.
  float opacity(const SurfaceInteraction& hit) const;
  bool opaque(std::uint32_t material) const { return prepared_[material].opaque; }

  // What is left of light after a way of `length` through the inside of the material.
  V3f transmittance(std::uint32_t material, float length) const;
  bool absorbs(std::uint32_t material) const { return prepared_[material].base.absorbing; }

 private:
  struct Prepared {
    SurfaceParameters base;
    V3f absorption{0.0f};  // per unit of length
    bool emits = false, opaque = true;
  };
  const Scene& scene_;
  std::vector<Prepared> prepared_;
};

}  // namespace morsel::render

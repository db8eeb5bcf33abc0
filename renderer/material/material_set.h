// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "renderer/accel/interaction.h"
#include "renderer/bsdf/surface_parameters.h"
#include "renderer/scene/scene.h"
#include "renderer/texture/texture_set.h"

namespace morsel::render {

// The materials of a scene, ready to be asked at hits: tables computed, textures open. Immutable.
// `wo` is the unit direction to the viewer.
class MaterialSet {
 public:
  // `scene` must outlive this object. Throws std::runtime_error for images that cannot be read.
  explicit MaterialSet(const Scene& scene);

  // What the surface is at a hit, with the shading normal that normal and bump maps make of the
  // hit's. Every alpha is at least `smallest_alpha`.
  struct Shading {
    SurfaceParameters parameters;
    V3f normal;
  };
  Shading shade(const SurfaceInteraction& hit, const V3f& wo, float smallest_alpha = 0.0f) const;
  // Emitted radiance, the same on both sides and in all directions.
  V3f emission(const SurfaceInteraction& hit, const V3f& wo) const;
  bool emits(std::uint32_t material) const { return prepared_[material].emits; }
  // Whether any image or ramp makes it differ from hit to hit.
  bool textured(std::uint32_t material) const {
    return prepared_[material].textured || prepared_[material].emission_textured;
  }
  // Whether that differs from the material's own value.
  bool emission_is_textured(std::uint32_t material) const {
    return prepared_[material].emission_textured;
  }
  // Share of rays that meet the surface at `hit`; the others pass as if it were not there.
  float opacity(const SurfaceInteraction& hit, const V3f& wo) const;
  bool opaque(std::uint32_t material) const { return prepared_[material].opaque; }

  // What is left of light after a way of `length` through the inside of the material.
  V3f transmittance(std::uint32_t material, float length) const;
  bool absorbs(std::uint32_t material) const { return prepared_[material].absorbs; }

  // Of the textures, for people; empty without images.
  std::string texture_statistics() const {
    return textures_.any_images() ? textures_.statistics() : std::string();
  }
  // See TextureStore::numbers(); empty without images.
  std::vector<std::pair<std::string, std::int64_t>> texture_numbers() const {
    return textures_.any_images() ? textures_.numbers()
                                  : std::vector<std::pair<std::string, std::int64_t>>();
  }

 private:
  struct Prepared {
    SurfaceParameters base;
    V3f absorption{0.0f};  // per unit of length
    bool emits = false, opaque = true, absorbs = false;
    bool textured = false;  // by anything but emission and opacity
    bool emission_textured = false;
  };
  void apply_textures(const Material& material, const TexturePoint& point, Shading& shading) const;
  void bend_normal(const Material& material, const TexturePoint& point, V3f& normal) const;

  const Scene& scene_;
  TextureSet textures_;
  std::vector<Prepared> prepared_;
};

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/bsdf/ggx.h"
#include "renderer/bsdf/lobe.h"

namespace morsel::render {

// Glass: exact Fresnel reflection and refraction at a smooth interface, or at GGX facets (Walter
// et al., "Microfacet Models for Refraction through Rough Surfaces", 2007). Weights carry radiance
// (they divide by eta^2 on refraction), since paths start at the camera.
class Dielectric {
 public:
  // `tint` multiplies refracted light, each time it crosses; `eta` is the index on the side that
  // the viewer is not on over the index on the viewer's side.
  Dielectric(const V3f& tint, float alpha, float eta) : tint_(tint), alpha_(alpha), eta_(eta) {}

  LobeValue evaluate(const V3f& wo, const V3f& wi) const;
  std::optional<LobeSample> sample(const V3f& wo, float choice, const V2f& u) const;
  // Facets between equal media do nothing, whatever their shape.
  bool delta() const { return alpha_ < Ggx::kSmallestAlpha || std::abs(eta_ - 1.0f) < 1e-4f; }
  float spread() const { return alpha_; }
  V3f albedo() const { return V3f(1.0f); }

 private:
  V3f tint_;
  float alpha_;
  float eta_;
};

}  // namespace morsel::render

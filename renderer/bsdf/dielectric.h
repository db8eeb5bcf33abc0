// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/bsdf/directional_albedo.h"
#include "renderer/bsdf/ggx.h"
#include "renderer/bsdf/lobe.h"

namespace morsel::render {

// Glass: exact Fresnel reflection and refraction at a smooth interface, or at GGX facets (Walter
// et al., "Microfacet Models for Refraction through Rough Surfaces", 2007). Weights carry radiance
// (they divide by eta^2 on refraction), since paths start at the camera.
//
// With `tables` the light of more than one bounce is put back by lobes of the form of complement()
// (directional_albedo.h) on both sides; it is shared out between the sides so that refraction stays
// reciprocal.
class Dielectric {
 public:
  // `tint` multiplies refracted light, each time it crosses. `ior` is that of the inside relative
  // to the outside, `outside` where the viewer is. `tables`, if any, are those of `ior`. Without
  // `scales_radiance` crossing light keeps its radiance.
  Dielectric(const V3f& tint, float alpha, float ior, bool outside,
             const InterfaceTables* tables = nullptr, bool scales_radiance = true)
      : tint_(tint),
        alpha_(alpha),
        eta_(outside ? ior : 1.0f / ior),
        radiance_ratio_(scales_radiance ? eta_ * eta_ : 1.0f),
        outside_(outside),
        tables_(delta() ? nullptr : tables) {}

  LobeValue evaluate(const V3f& wo, const V3f& wi) const;
  std::optional<LobeSample> sample(const V3f& wo, float choice, const V2f& u) const;
  // Facets between equal media do nothing, whatever their shape.
  bool delta() const { return alpha_ < Ggx::kSmallestAlpha || std::abs(eta_ - 1.0f) < 1e-4f; }
  float spread() const { return alpha_; }
  V3f albedo() const { return V3f(1.0f); }

 private:
  LobeValue evaluate_once(const V3f& wo, const V3f& wi) const;
  std::optional<LobeSample> sample_once(const V3f& wo, float choice, const V2f& u) const;
  // Adds the lobes of many bounces to a value and mixes their density in.
  void add_many(const V3f& wo, const V3f& wi, LobeValue& v) const;
  const AlbedoTable& here() const { return tables_->side(outside_).total; }
  const AlbedoTable& there() const { return tables_->side(!outside_).total; }
  // Share of the light of many bounces that ends up on the other side.
  float crossing() const;

  V3f tint_;
  float alpha_;
  float eta_;
  float radiance_ratio_;  // what crossing light's radiance is divided by
  bool outside_;
  const InterfaceTables* tables_;
};

}  // namespace morsel::render

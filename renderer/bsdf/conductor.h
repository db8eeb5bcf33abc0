// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/bsdf/albedo_table.h"
#include "renderer/bsdf/ggx.h"
#include "renderer/bsdf/lobe.h"

namespace morsel::render {

// Metal: GGX reflection with Schlick's Fresnel term; a perfect mirror below Ggx::kSmallestAlpha.
// Light that the facets reflect more than once is put back by complement() (directional_albedo.h),
// coloured by the mean of the Fresnel term at every bounce, so a white metal is white at any
// roughness, and the lobe is reciprocal.
class Conductor {
 public:
  // `reflectance` at normal incidence, in [0, 1]; alpha is GGX's, in [0, 1].
  Conductor(const V3f& reflectance, float alpha, bool compensate = true)
      : reflectance_(reflectance),
        alpha_(alpha),
        compensate_(compensate),
        place_(AlbedoTable::alpha_place(alpha)),
        many_color_(compensate && !delta() ? many_bounces() : V3f(0.0f)) {}

  LobeValue evaluate(const V3f& wo, const V3f& wi) const;
  std::optional<LobeSample> sample(const V3f& wo, float choice, const V2f& u) const;
  bool delta() const { return alpha_ < Ggx::kSmallestAlpha; }
  float spread() const { return alpha_; }
  V3f albedo() const { return reflectance_; }

 private:
  V3f many_bounces() const;  // colour of complement()
  float many_probability(const V3f& wo) const;
  LobeValue evaluate(const V3f& wo, const V3f& wi, float many) const;  // many: the above

  V3f reflectance_;
  float alpha_;
  bool compensate_;
  AlbedoTable::Place place_;  // of alpha in tables
  V3f many_color_;            // many_bounces()
};

}  // namespace morsel::render

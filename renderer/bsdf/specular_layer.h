// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/bsdf/directional_albedo.h"
#include "renderer/bsdf/ggx.h"
#include "renderer/bsdf/lobe.h"

namespace morsel::render {

// The reflection of a GGX dielectric interface, whose refracted light is the business of what lies
// under it: a clear coat, or the gloss of plastic. As KHR_materials_specular has it, `weight`
// scales all of it and `tint` the reflectance at normal incidence; with both at 1 the Fresnel term
// is exact.
class SpecularLayer {
 public:
  // `tables` are those of the interface's index; alpha below Ggx::kSmallestAlpha is raised to it.
  SpecularLayer(float weight, const V3f& tint, float alpha, const InterfaceTables& tables);

  LobeValue evaluate(const V3f& wo, const V3f& wi) const;
  // What sample() draws, before it is evaluated; it may point below the surface.
  V3f direction(const V3f& wo, const V2f& u) const { return Ggx(alpha_).sample_reflection(wo, u); }
  std::optional<LobeSample> sample(const V3f& wo, float choice, const V2f& u) const;
  bool delta() const { return false; }
  float spread() const { return alpha_; }
  V3f albedo() const { return normal_ * weight_; }

  // Share of light that it reflects towards this cosine, and its mean over the hemisphere.
  // Of the channel that has most.
  float directional_albedo(float cos_theta) const {
    const auto cosine = AlbedoTable::cosine_place(cos_theta);
    return most(tables_->reflected.at(cosine, place_), mirror_->at(cosine, place_));
  }
  float average_albedo() const {
    return most(tables_->reflected.average(place_), mirror_->average(place_));
  }

 private:
  V3f fresnel(float cos_theta) const;
  float most(float exact, float mirror) const;
  float rise(float exact, float mirror) const {
    return std::max(0.0f, (exact - f0_ * mirror) * per_rest_);
  }

  float weight_, alpha_, ior_;
  float f0_;        // exact reflectance at normal incidence
  float per_rest_;  // over 1 - that
  V3f normal_;      // the same, tinted
  const InterfaceAlbedo* tables_;
  const AlbedoTable* mirror_;  // of F = 1
  AlbedoTable::Place place_;   // of alpha in them
};

}  // namespace morsel::render

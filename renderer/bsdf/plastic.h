// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/bsdf/diffuse.h"
#include "renderer/bsdf/specular_layer.h"

namespace morsel::render {

// A matte body under a dielectric interface. The body gets what the interface lets through, by the
// reciprocal coupling (1 - R(wo)) (1 - R(wi)) / (1 - R_avg) of Kelemen & Szirmay-Kalos ("A
// Microfacet Based Coupled Specular-Matte BRDF Model", 2001), so a white body is white whatever the
// gloss.
class Plastic {
 public:
  // The interface is one of SpecularLayer, which is made in place: copying what was just written
  // makes the processor wait.
  Plastic(const Diffuse& body, float weight, const V3f& tint, float alpha,
          const InterfaceTables& tables)
      : body_(body),
        gloss_(weight, tint, alpha, tables),
        strength_(max_component(body.albedo())),
        coupling_((1.0f - 0.003f * body.roughness()) /
                  std::max(1e-6f, 1.0f - gloss_.average_albedo())) {}

  LobeValue evaluate(const V3f& wo, const V3f& wi) const;
  std::optional<LobeSample> sample(const V3f& wo, float choice, const V2f& u) const;
  bool delta() const { return false; }
  float spread() const { return 1.0f; }
  V3f albedo() const {
    return body_.albedo() * (1.0f - max_component(gloss_.albedo())) + gloss_.albedo();
  }

 private:
  // Share of light that the gloss reflects towards this cosine, of the channel that has most.
  float reflected(float cosine) const { return gloss_.directional_albedo(cosine); }
  float gloss_probability(float reflected) const;
  LobeValue evaluate(const V3f& wo, const V3f& wi, float reflected_o) const;

  Diffuse body_;
  SpecularLayer gloss_;
  float strength_;  // brightest channel of the body
  // 1 / (1 - R_avg), which is exact for Lambert's law; grooves send a little more light to where
  // more passes, 0.6 % at the most.
  float coupling_;
};

}  // namespace morsel::render

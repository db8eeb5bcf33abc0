// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/plastic.h"

namespace morsel::render {

// Of sampling the gloss, which reflects the share `reflected` of what comes along wo.
float Plastic::gloss_probability(float reflected) const {
  const float d = (1.0f - reflected) * strength_;
  return reflected + d > 0.0f ? reflected / (reflected + d) : 1.0f;
}

LobeValue Plastic::evaluate(const V3f& wo, const V3f& wi) const {
  if (wi.z <= 0.0f) return {};
  return evaluate(wo, wi, reflected(wo.z));
}

LobeValue Plastic::evaluate(const V3f& wo, const V3f& wi, float reflected_o) const {
  const LobeValue body = body_.evaluate(wo, wi), gloss = gloss_.evaluate(wo, wi);
  const float p = gloss_probability(reflected_o);
  return {body.value * (coupling_ * (1.0f - reflected_o) * (1.0f - reflected(wi.z))) + gloss.value,
          (1.0f - p) * body.pdf + p * gloss.pdf};
}

std::optional<LobeSample> Plastic::sample(const V3f& wo, float choice, const V2f& u) const {
  const float reflected_o = reflected(wo.z);
  const bool diffuse = !(choice < gloss_probability(reflected_o));
  const V3f wi = diffuse ? square_to_cosine_hemisphere(u) : gloss_.direction(wo, u);
  if (wi.z <= 0.0f) return std::nullopt;
  const LobeValue v = evaluate(wo, wi, reflected_o);
  if (v.pdf <= 0.0f) return std::nullopt;
  return LobeSample{.wi = wi, .weight = v.value * (1.0f / v.pdf), .pdf = v.pdf, .diffuse = diffuse};
}

}  // namespace morsel::render

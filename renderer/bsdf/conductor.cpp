// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/conductor.h"

#include "renderer/bsdf/directional_albedo.h"
#include "renderer/bsdf/fresnel.h"

namespace morsel::render {

V3f Conductor::compensation(const V3f& wo) const {
  if (!compensate_) return V3f(1.0f);
  const float e = ggx_directional_albedo(wo.z, alpha_);
  return V3f(1.0f) + reflectance_ * ((1.0f - e) / e);
}

LobeValue Conductor::evaluate(const V3f& wo, const V3f& wi) const {
  if (delta() || wi.z <= 0.0f) return {};
  const V3f sum = wo + wi;
  if (!(dot(sum, sum) > 0.0f)) return {};
  const V3f h = normalize(sum);
  const Ggx ggx(alpha_);
  const float d = ggx.distribution(h);
  // f * wi.z = F D G / (4 wo.z wi.z) * wi.z
  const float value = d * ggx.masking_shadowing(wo, wi) / (4.0f * wo.z);
  const float pdf = d * ggx.masking(wo) / (4.0f * wo.z);
  return {fresnel_schlick(reflectance_, dot(wo, h)) * compensation(wo) * value, pdf};
}

std::optional<LobeSample> Conductor::sample(const V3f& wo, float /*choice*/, const V2f& u) const {
  if (delta()) {
    return LobeSample{.wi = V3f(-wo.x, -wo.y, wo.z),
                      .weight = fresnel_schlick(reflectance_, wo.z),
                      .delta = true};
  }
  const Ggx ggx(alpha_);
  const V3f h = ggx.sample_visible(wo, u);
  const float cos_h = dot(wo, h);
  const V3f wi = normalize(h * (2.0f * cos_h) - wo);
  if (wi.z <= 0.0f || cos_h <= 0.0f) return std::nullopt;
  const float masking = ggx.masking(wo);
  return LobeSample{.wi = wi,
                    .weight = fresnel_schlick(reflectance_, cos_h) * compensation(wo) *
                              (ggx.masking_shadowing(wo, wi) / masking),
                    .pdf = ggx.distribution(h) * masking / (4.0f * wo.z)};
}

}  // namespace morsel::render

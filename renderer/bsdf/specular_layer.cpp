// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/specular_layer.h"

#include "renderer/bsdf/fresnel.h"

namespace morsel::render {

SpecularLayer::SpecularLayer(float weight, const V3f& tint, float alpha,
                             const InterfaceTables& tables)
    : weight_(weight),
      alpha_(std::max(alpha, Ggx::kSmallestAlpha)),
      ior_(tables.ior),
      f0_(tables.normal),
      per_rest_(f0_ < 1.0f ? 1.0f / (1.0f - f0_) : 0.0f),
      normal_(std::min(1.0f, f0_ * tint.x), std::min(1.0f, f0_ * tint.y),
              std::min(1.0f, f0_ * tint.z)),
      tables_(&tables.outside),
      mirror_(&ggx_albedo()),
      place_(AlbedoTable::alpha_place(alpha_)) {}

// From the tinted reflectance at normal incidence to 1, by as much of the way as the exact term has
// gone from its own.
V3f SpecularLayer::fresnel(float cos_theta) const {
  float cos_t;
  const float f = rise(fresnel_dielectric(cos_theta, ior_, cos_t), 1.0f);
  return (normal_ * (1.0f - f) + V3f(f)) * weight_;
}

// Linear in the Fresnel term, so it holds for albedos too: `exact` is that of the exact term,
// `mirror` that of F = 1.
float SpecularLayer::most(float exact, float mirror) const {
  const float r = rise(exact, mirror);
  return (max_component(normal_) * (mirror - r) + r) * weight_;
}

LobeValue SpecularLayer::evaluate(const V3f& wo, const V3f& wi) const {
  if (wi.z <= 0.0f) return {};
  const Ggx::Reflection facets = Ggx(alpha_).reflection(wo, wi);
  return {fresnel(facets.cosine) * facets.value, facets.pdf};
}

std::optional<LobeSample> SpecularLayer::sample(const V3f& wo, float /*choice*/,
                                                const V2f& u) const {
  LobeSample s;
  s.wi = direction(wo, u);
  const LobeValue v = evaluate(wo, s.wi);
  if (v.pdf <= 0.0f) return std::nullopt;
  s.pdf = v.pdf;
  s.weight = v.value / v.pdf;
  return s;
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/conductor.h"

#include "renderer/bsdf/directional_albedo.h"
#include "renderer/bsdf/fresnel.h"
#include "renderer/math/warp.h"

namespace morsel::render {

V3f Conductor::many_bounces() const {
  const float e = ggx_albedo().average(place_);
  V3f color;
  for (int i = 0; i < 3; ++i) {
    // Mean of Schlick's term over the hemisphere; then the geometric series of further bounces.
    const float f = reflectance_[i] + (1.0f - reflectance_[i]) / 21.0f;
    color[i] = f * f * e / (1.0f - f * (1.0f - e));
  }
  return color;
}

// Of sampling the lobe of many bounces: its share of the light of a white metal.
float Conductor::many_probability(const V3f& wo) const {
  return compensate_ ? 1.0f - ggx_albedo().at(AlbedoTable::cosine_place(wo.z), place_) : 0.0f;
}

LobeValue Conductor::evaluate(const V3f& wo, const V3f& wi) const {
  if (delta() || wi.z <= 0.0f) return {};
  return evaluate(wo, wi, many_probability(wo));
}

LobeValue Conductor::evaluate(const V3f& wo, const V3f& wi, float many) const {
  if (wi.z <= 0.0f) return {};
  const Ggx::Reflection facets = Ggx(alpha_).reflection(wo, wi);
  LobeValue v{fresnel_schlick(reflectance_, facets.cosine) * facets.value, facets.pdf};
  if (compensate_) {
    const AlbedoTable& table = ggx_albedo();
    v.value += many_color_ * complement(table, table, place_, wo.z, wi.z);
    v.pdf = (1.0f - many) * v.pdf + many * wi.z * kInvPi;
  }
  return v;
}

std::optional<LobeSample> Conductor::sample(const V3f& wo, float choice, const V2f& u) const {
  if (delta()) {
    return LobeSample{.wi = V3f(-wo.x, -wo.y, wo.z),
                      .weight = fresnel_schlick(reflectance_, wo.z),
                      .delta = true};
  }
  LobeSample s;
  const float many = many_probability(wo);
  if (choice < many) {
    s.wi = square_to_cosine_hemisphere(u);
  } else {
    s.wi = Ggx(alpha_).sample_reflection(wo, u);
  }
  const LobeValue v = evaluate(wo, s.wi, many);
  if (v.pdf <= 0.0f) return std::nullopt;
  s.pdf = v.pdf;
  s.weight = v.value * (1.0f / v.pdf);
  return s;
}

}  // namespace morsel::render

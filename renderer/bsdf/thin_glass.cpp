// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/thin_glass.h"

#include "renderer/bsdf/fresnel.h"
#include "renderer/math/warp.h"

namespace morsel::render {

float ThinGlass::reflectance(float cos_theta) const {
  float cos_t;
  const float r = fresnel_dielectric(cos_theta, ior_, cos_t);
  return 2.0f * r / (1.0f + r);
}

LobeValue ThinGlass::evaluate(const V3f& wo, const V3f& wi) const {
  if (delta() || wi.z == 0.0f) return {};
  const bool reflection = wi.z > 0.0f;
  const V3f upper(wi.x, wi.y, std::abs(wi.z));
  const V3f h = normalize(wo + upper);
  const Ggx ggx(alpha_);
  const float r = reflectance(dot(wo, h));
  const float share = reflection ? r : 1.0f - r;
  const float d = ggx.distribution(h) / (4.0f * wo.z);
  const float missing = 1.0f - ggx_albedo()(wo.z, alpha_);
  const float many = 0.5f * complement(ggx_albedo(), ggx_albedo(), alpha_, wo.z, upper.z);
  const float value = share * d * ggx.masking_shadowing(wo, upper) + many;
  return {(reflection ? V3f(1.0f) : tint_) * value,
          (1.0f - missing) * share * d * ggx.masking(wo) + missing * 0.5f * upper.z * kInvPi};
}

std::optional<LobeSample> ThinGlass::sample(const V3f& wo, float choice, const V2f& u) const {
  LobeSample s;
  if (delta()) {
    const float r = reflectance(wo.z);
    s.delta = true;
    s.transmission = choice >= r;
    s.wi = s.transmission ? -wo : V3f(-wo.x, -wo.y, wo.z);
    s.weight = s.transmission ? tint_ : V3f(1.0f);
    return s;
  }
  const float missing = 1.0f - ggx_albedo()(wo.z, alpha_);
  if (choice < missing) {
    s.wi = square_to_cosine_hemisphere(u);
    s.transmission = choice < 0.5f * missing;
  } else {
    const V3f h = Ggx(alpha_).sample_visible(wo, u);
    s.wi = normalize(h * (2.0f * dot(wo, h)) - wo);
    if (s.wi.z <= 0.0f) return std::nullopt;
    s.transmission = (choice - missing) / (1.0f - missing) >= reflectance(dot(wo, h));
  }
  if (s.transmission) s.wi.z = -s.wi.z;
  const LobeValue v = evaluate(wo, s.wi);
  if (v.pdf <= 0.0f) return std::nullopt;
  s.pdf = v.pdf;
  s.weight = v.value / v.pdf;
  return s;
}

}  // namespace morsel::render

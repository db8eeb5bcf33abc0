// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/dielectric.h"

#include "renderer/bsdf/fresnel.h"

namespace morsel::render {

LobeValue Dielectric::evaluate(const V3f& wo, const V3f& wi) const {
  if (delta() || wi.z == 0.0f) return {};
  const bool reflection = wi.z > 0.0f;
  // Half vector of reflection, or the generalised one of refraction, on the viewer's side.
  V3f h = reflection ? wo + wi : wo + wi * eta_;
  if (!(dot(h, h) > 0.0f)) return {};
  h = normalize(h);
  if (h.z < 0.0f) h = -h;
  const float cos_o = dot(wo, h), cos_i = dot(wi, h);
  // Each direction must see the facet from the side on which it sees the surface.
  if (cos_o <= 0.0f || cos_i * wi.z <= 0.0f) return {};

  const Ggx ggx(alpha_);
  float cos_t;
  const float f = fresnel_dielectric(cos_o, eta_, cos_t);
  const float d = ggx.distribution(h);
  const float g = ggx.masking_shadowing(wo, wi);
  const float masking = ggx.masking(wo);
  if (reflection) {
    const float common = f * d / (4.0f * wo.z);
    return {V3f(common * g), common * masking};
  }
  const float denominator = square(cos_i + cos_o / eta_);
  const float common = (1.0f - f) * d * cos_o * std::abs(cos_i) / (wo.z * denominator);
  return {tint_ * (common * g / (eta_ * eta_)), common * masking};
}

std::optional<LobeSample> Dielectric::sample(const V3f& wo, float choice, const V2f& u) const {
  const bool smooth = delta();
  const Ggx ggx(alpha_);
  const V3f h = smooth ? V3f(0.0f, 0.0f, 1.0f) : ggx.sample_visible(wo, u);
  const float cos_o = dot(wo, h);
  if (cos_o <= 0.0f) return std::nullopt;
  float cos_t;
  const float f = fresnel_dielectric(cos_o, eta_, cos_t);

  LobeSample s;
  s.delta = smooth;
  s.transmission = choice >= f;
  if (s.transmission) {
    s.wi = normalize(wo * (-1.0f / eta_) + h * (cos_o / eta_ - cos_t));
    if (s.wi.z >= 0.0f) return std::nullopt;
    s.eta_squared = eta_ * eta_;
    s.weight = tint_ * (1.0f / s.eta_squared);
  } else {
    s.wi = normalize(h * (2.0f * cos_o) - wo);
    if (s.wi.z <= 0.0f) return std::nullopt;
    s.weight = V3f(1.0f);
  }
  if (smooth) return s;

  const float masking = ggx.masking(wo);
  s.weight *= ggx.masking_shadowing(wo, s.wi) / masking;
  const float visible = masking * ggx.distribution(h) / wo.z;  // density of h, over cos_o
  if (s.transmission) {
    const float cos_i = dot(s.wi, h);
    s.pdf = (1.0f - f) * visible * cos_o * std::abs(cos_i) / square(cos_i + cos_o / eta_);
  } else {
    s.pdf = f * visible / 4.0f;
  }
  return s;
}

}  // namespace morsel::render

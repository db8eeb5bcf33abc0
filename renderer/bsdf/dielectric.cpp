// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/dielectric.h"

#include "renderer/bsdf/fresnel.h"
#include "renderer/math/warp.h"

namespace morsel::render {

// Reciprocity asks f(wo, wi) eta^2 = f(wi, wo) of the two crossing lobes, in radiance; with
// c (1 - E(wo)) (1 - E'(wi)) / (pi (1 - E'_avg)) on this side and the same with primes exchanged on
// the other, c / (1 - E'_avg) = eta^2 c' / (1 - E_avg). The choice below fulfils it.
float Dielectric::crossing() const {
  const float this_rest = 1.0f - here().average(alpha_);
  const float other_rest = square(eta_) * (1.0f - there().average(alpha_));
  const float sum = this_rest + other_rest;
  return sum > 0.0f ? other_rest / sum : 0.0f;
}

void Dielectric::add_many(const V3f& wo, const V3f& wi, LobeValue& v) const {
  const float missing = 1.0f - here()(wo.z, alpha_);
  const float c = crossing(), cosine = std::abs(wi.z);
  v.pdf *= 1.0f - missing;
  if (wi.z > 0.0f) {
    v.value += V3f((1.0f - c) * complement(here(), here(), alpha_, wo.z, cosine));
    v.pdf += missing * (1.0f - c) * cosine * kInvPi;
  } else {
    v.value += tint_ * (c / radiance_ratio_ * complement(here(), there(), alpha_, wo.z, cosine));
    v.pdf += missing * c * cosine * kInvPi;
  }
}

LobeValue Dielectric::evaluate(const V3f& wo, const V3f& wi) const {
  if (delta() || wi.z == 0.0f) return {};
  LobeValue v = evaluate_once(wo, wi);
  if (tables_ != nullptr) add_many(wo, wi, v);
  return v;
}

std::optional<LobeSample> Dielectric::sample(const V3f& wo, float choice, const V2f& u) const {
  if (tables_ == nullptr) return sample_once(wo, choice, u);
  const float missing = 1.0f - here()(wo.z, alpha_);
  LobeValue v;
  std::optional<LobeSample> s;
  if (choice < missing) {
    s.emplace();
    s->transmission = choice < missing * crossing();
    s->wi = square_to_cosine_hemisphere(u);
    if (s->transmission) {
      s->wi.z = -s->wi.z;
      s->eta_squared = radiance_ratio_;
    }
    if (s->wi.z == 0.0f) return std::nullopt;
    v = evaluate_once(wo, s->wi);
  } else {
    s = sample_once(wo, std::min((choice - missing) / (1.0f - missing), kOneMinusEpsilon), u);
    if (!s) return s;
    // Not evaluated again: the half vector would lose digits.
    v = {s->weight * s->pdf, s->pdf};
  }
  add_many(wo, s->wi, v);
  if (v.pdf <= 0.0f) return std::nullopt;
  s->pdf = v.pdf;
  s->weight = v.value / v.pdf;
  return s;
}

LobeValue Dielectric::evaluate_once(const V3f& wo, const V3f& wi) const {
  const bool reflection = wi.z > 0.0f;
  // Half vector of reflection, or the generalised one of refraction, on the viewer's side.
  V3f h = reflection ? wo + wi : wo + wi * eta_;
  if (dot(h, h) <= 0.0f) return {};
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
  return {tint_ * (common * g / radiance_ratio_), common * masking};
}

std::optional<LobeSample> Dielectric::sample_once(const V3f& wo, float choice, const V2f& u) const {
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
    s.eta_squared = radiance_ratio_;
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

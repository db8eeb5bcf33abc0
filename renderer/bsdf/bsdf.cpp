// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/bsdf.h"

#include <limits>

namespace morsel::render {
namespace {

constexpr float kGrazing = 1e-4f;  // smallest cosine between the viewer and the shading normal

// The shading normal, turned until `wo` and its mirror direction are above the surface. All
// arguments are on the viewer's side of the surface or in its plane.
V3f usable_normal(const V3f& shading, const V3f& geometric, const V3f& wo) {
  V3f n = shading;
  const float above = dot(n, wo);
  if (above < kGrazing) n = normalize(n + wo * (kGrazing - above));
  const V3f mirrored = n * (2.0f * dot(n, wo)) - wo;
  const float height = dot(mirrored, geometric);
  if (height < kGrazing) {
    n = normalize(wo + normalize(mirrored + geometric * (kGrazing - height)));
  }
  return n;
}

}  // namespace

// Each is made where it stays: copying what was just written makes the processor wait.
Lobe make_lobe(const SurfaceParameters& p, bool outside) {
  const auto dielectric = [&] {
    return Lobe(std::in_place_type<Dielectric>, crossing_tint(p), p.alpha, p.ior, outside, p.tables,
                p.scales_radiance);
  };
  const auto layered = [&] { return Lobe(std::in_place_type<Principled>, p, outside); };
  switch (p.type) {
    case MaterialType::kConductor:
      return Lobe(std::in_place_type<Conductor>, p.color, p.alpha);
    case MaterialType::kDielectric:
      return dielectric();
    case MaterialType::kDiffuse:
      return Lobe(std::in_place_type<Diffuse>, p.color, p.diffuse_roughness);
    case MaterialType::kPrincipled:
      break;
  }
  if (p.clearcoat > 0.0f || max_component(p.sheen_color) > 0.0f) return layered();
  if (p.metallic >= 1.0f) return Lobe(std::in_place_type<Conductor>, p.color, p.alpha);
  if (p.metallic <= 0.0f && p.transmission >= 1.0f) {
    if (p.thin) return Lobe(std::in_place_type<ThinGlass>, p.color, p.alpha, p.ior);
    return dielectric();
  }
  if (p.metallic <= 0.0f && p.transmission <= 0.0f) {
    const Diffuse body(p.color, p.diffuse_roughness);
    if (p.specular <= 0.0f) return Lobe(std::in_place_type<Diffuse>, body);
    return Lobe(std::in_place_type<Plastic>, body, p.specular, p.specular_color, p.alpha,
                *p.tables);
  }
  return layered();
}

Bsdf::Bsdf(const SurfaceParameters& parameters, const V3f& geometric_normal,
           const V3f& shading_normal, const V3f& wo)
    : geometric_normal_(dot(wo, geometric_normal) >= 0.0f ? geometric_normal : -geometric_normal),
      smooth_(shading_normal != geometric_normal),
      frame_(smooth_
                 ? usable_normal(dot(shading_normal, geometric_normal_) >= 0.0f ? shading_normal
                                                                                : -shading_normal,
                                 geometric_normal_, wo)
                 : geometric_normal_),
      per_agreement_(smooth_ ? 1.0f / dot(frame_.z, geometric_normal_) : 1.0f),
      wo_(frame_.to_local(wo)),
      lobe_(make_lobe(parameters, dot(wo, geometric_normal) >= 0.0f)) {
  wo_.z = std::max(wo_.z, 1e-6f);  // wo may lie in the surface to within rounding
}

float Bsdf::terminator(const V3f& wi) const {
  const float shading = dot(wi, frame_.z);
  if (!smooth_ || shading <= 0.0f) return 1.0f;
  const float above = dot(wi, geometric_normal_) * per_agreement_;
  if (above >= shading) return 1.0f;
  const float g = above / shading;
  return g <= 0.0f ? 0.0f : g * (1.0f + g * (1.0f - g));
}

LobeValue Bsdf::evaluate(const V3f& wi) const {
  const V3f local = frame_.to_local(wi);
  if ((dot(wi, geometric_normal_) > 0.0f) != (local.z > 0.0f)) return {};
  LobeValue v = std::visit([&](const auto& lobe) { return lobe.evaluate(wo_, local); }, lobe_);
  v.value *= terminator(wi);
  return v;
}

std::optional<LobeSample> Bsdf::sample(float choice, const V2f& u) const {
  auto s = std::visit([&](const auto& lobe) { return lobe.sample(wo_, choice, u); }, lobe_);
  if (!s) return s;
  s->wi = renormalize(frame_.to_world(s->wi));
  if (!is_finite(s->wi) || std::isnan(s->pdf)) {  // on neither side, and not for nothing
    s->weight = V3f(std::numeric_limits<float>::quiet_NaN());
    return s;
  }
  if ((dot(s->wi, geometric_normal_) > 0.0f) == s->transmission) return std::nullopt;
  if (!s->delta) s->weight *= terminator(s->wi);
  return s;
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/principled.h"

namespace morsel::render {
namespace {

std::variant<Dielectric, ThinGlass> glass_of(const SurfaceParameters& p, bool outside) {
  const float alpha = std::max(p.alpha, Ggx::kSmallestAlpha);
  if (p.thin) return ThinGlass(p.color, alpha, p.ior);
  // An index that is almost that of the surroundings would make the interface a delta lobe.
  const float ior = std::abs(p.ior - 1.0f) < 1e-3f ? 1.001f : p.ior;
  return Dielectric(crossing_tint(p), alpha, ior, outside, p.tables, p.scales_radiance);
}

}  // namespace

V3f crossing_tint(const SurfaceParameters& p) {
  if (!p.tints_crossings) return V3f(1.0f);
  return {std::sqrt(p.color.x), std::sqrt(p.color.y), std::sqrt(p.color.z)};
}

Principled::Principled(const SurfaceParameters& p, bool outside)
    : metallic_(p.metallic),
      transmission_(p.transmission),
      sheen_strength_(max_component(p.sheen_color)),
      sheen_alpha_(p.sheen_alpha),
      plastic_strength_(1.0f),
      metal_strength_(1.0f),
      coated_(p.clearcoat > 0.0f),
      coat_(p.clearcoat, V3f(1.0f), p.clearcoat_alpha, *p.coat_tables),
      sheen_(p.sheen_color, p.sheen_alpha),
      metal_(p.color, std::max(p.alpha, Ggx::kSmallestAlpha), p.metallic > 0.0f),
      glass_(glass_of(p, outside)),
      plastic_(Diffuse(p.color, p.diffuse_roughness), p.specular, p.specular_color, p.alpha,
               *p.tables) {
  if (!outside && transmission_ > 0.0f) {  // the layers are on the other side
    coated_ = false;
    sheen_strength_ = 0.0f;
  }
  // What the probabilities of sampling go by must not vanish where the value does not.
  plastic_strength_ = std::max(0.05f, max_component(plastic_.albedo()));
  metal_strength_ = std::max(0.05f, max_component(p.color));
  const float opaque = (1.0f - metallic_) * (1.0f - transmission_);
  spread_ = opaque > 0.5f ? 1.0f : std::max(p.alpha, opaque);
  albedo_ =
      p.color * metallic_ + V3f((1.0f - metallic_) * transmission_) + plastic_.albedo() * opaque;
}

Principled::Shares Principled::shares(const V3f& wo) const {
  Shares s{};
  float rest = 1.0f, total = 0.0f;
  const auto add = [&](Part part, float scale, float strength) {
    s.scale[part] = scale;
    s.probability[part] = scale * strength;
    total += s.probability[part];
  };
  if (coated_) {
    const float reflected = coat_.directional_albedo(wo.z);
    add(kCoat, 1.0f, reflected);
    rest *= 1.0f - reflected;
  }
  if (sheen_strength_ > 0.0f) {
    const float reflected = std::min(1.0f, sheen_strength_ * sheen_albedo()(wo.z, sheen_alpha_));
    add(kSheen, rest, reflected);
    rest *= 1.0f - reflected;
  }
  add(kMetal, rest * metallic_, metal_strength_);
  add(kGlass, rest * (1.0f - metallic_) * transmission_, 1.0f);
  add(kPlastic, rest * (1.0f - metallic_) * (1.0f - transmission_), plastic_strength_);
  // Of what is no number neither: it is passed on.
  const float scale = total <= 0.0f ? 0.0f : 1.0f / total;
  for (float& p : s.probability) p *= scale;
  return s;
}

LobeValue Principled::evaluate(const V3f& wo, const V3f& wi) const {
  const Shares s = shares(wo);
  LobeValue sum;
  const auto add = [&](Part part, const auto& lobe) {
    if (s.scale[part] <= 0.0f) return;
    const LobeValue v = lobe.evaluate(wo, wi);
    sum.value += v.value * s.scale[part];
    sum.pdf += v.pdf * s.probability[part];
  };
  add(kCoat, coat_);
  add(kSheen, sheen_);
  add(kMetal, metal_);
  std::visit([&](const auto& glass) { add(kGlass, glass); }, glass_);
  add(kPlastic, plastic_);
  return sum;
}

std::optional<LobeSample> Principled::sample(const V3f& wo, float choice, const V2f& u) const {
  const Shares s = shares(wo);
  int part = 0, last = -1;
  for (; part < kParts; ++part) {
    if (s.probability[part] <= 0.0f) continue;
    last = part;
    if (choice < s.probability[part]) break;
    choice -= s.probability[part];
  }
  if (last < 0) return std::nullopt;
  part = last;  // also when rounding left something over
  const float again = std::clamp(choice / s.probability[part], 0.0f, kOneMinusEpsilon);
  std::optional<LobeSample> drawn;
  switch (part) {
    case kCoat:
      drawn = coat_.sample(wo, again, u);
      break;
    case kSheen:
      drawn = sheen_.sample(wo, again, u);
      break;
    case kMetal:
      drawn = metal_.sample(wo, again, u);
      break;
    case kGlass:
      drawn = std::visit([&](const auto& g) { return g.sample(wo, again, u); }, glass_);
      break;
    default:
      drawn = plastic_.sample(wo, again, u);
  }
  if (!drawn) return drawn;
  // The part's own density need not be computed twice, and may not be: a half vector loses digits.
  LobeValue v{drawn->weight * (drawn->pdf * s.scale[part]), drawn->pdf * s.probability[part]};
  const auto add = [&](Part other, const auto& lobe) {
    if (other == part || s.scale[other] <= 0.0f) return;
    const LobeValue o = lobe.evaluate(wo, drawn->wi);
    v.value += o.value * s.scale[other];
    v.pdf += o.pdf * s.probability[other];
  };
  add(kCoat, coat_);
  add(kSheen, sheen_);
  add(kMetal, metal_);
  std::visit([&](const auto& glass) { add(kGlass, glass); }, glass_);
  add(kPlastic, plastic_);
  drawn->pdf = v.pdf;
  drawn->weight = v.value / v.pdf;
  return drawn;
}

}  // namespace morsel::render

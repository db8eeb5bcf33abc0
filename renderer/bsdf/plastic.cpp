// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/plastic.h"

namespace morsel::render {

float Plastic::gloss_probability(const V3f& wo) const {
  const float r = max_component(gloss_.directional_albedo(wo.z));
  const float d = (1.0f - r) * max_component(body_.albedo());
  return r + d > 0.0f ? r / (r + d) : 1.0f;
}

LobeValue Plastic::evaluate(const V3f& wo, const V3f& wi) const {
  if (wi.z <= 0.0f) return {};
  const LobeValue body = body_.evaluate(wo, wi), gloss = gloss_.evaluate(wo, wi);
  const auto passed = [&](float cosine) {
    return 1.0f - max_component(gloss_.directional_albedo(cosine));
  };
  const float rest = std::max(1e-6f, 1.0f - max_component(gloss_.average_albedo()));
  const float p = gloss_probability(wo);
  // The coupling is exact for Lambert's law; grooves send a little more light to where more passes,
  // 0.6 % at the most.
  const float grooves = 1.0f - 0.003f * body_.roughness();
  return {body.value * (grooves * passed(wo.z) * passed(wi.z) / rest) + gloss.value,
          (1.0f - p) * body.pdf + p * gloss.pdf};
}

std::optional<LobeSample> Plastic::sample(const V3f& wo, float choice, const V2f& u) const {
  const auto s =
      choice < gloss_probability(wo) ? gloss_.sample(wo, 0.0f, u) : body_.sample(wo, 0.0f, u);
  if (!s) return s;
  const LobeValue v = evaluate(wo, s->wi);
  if (!(v.pdf > 0.0f)) return std::nullopt;
  return LobeSample{.wi = s->wi, .weight = v.value / v.pdf, .pdf = v.pdf, .diffuse = s->diffuse};
}

}  // namespace morsel::render

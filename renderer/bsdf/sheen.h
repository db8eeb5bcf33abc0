// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/bsdf/lobe.h"
#include "renderer/math/warp.h"

namespace morsel::render {

// The sheen of cloth as KHR_materials_sheen has it: fibres stand up from the surface, D being
// Estevez & Kulla's ("Production Friendly Microfacet Sheen BRDF", 2017) with the visibility term of
// Neubelt & Pettineo (2013), f = color * D * V. Sampled by the cosine.
class Sheen {
 public:
  // alpha in [0, 1] is the square of the perceptual roughness; narrower than 0.005 is not resolved.
  Sheen(const V3f& color, float alpha) : color_(color), alpha_(std::max(alpha, 0.005f)) {}

  LobeValue evaluate(const V3f& wo, const V3f& wi) const {
    if (wi.z <= 0.0f) return {};
    const V3f sum = wo + wi;
    const float length2 = dot(sum, sum);
    if (length2 <= 0.0f) return {};
    const float cos2 = sum.z * sum.z / length2;
    const float inverse = 1.0f / alpha_;
    const float d =
        (2.0f + inverse) * std::pow(std::max(0.0f, 1.0f - cos2), 0.5f * inverse) * (0.5f * kInvPi);
    const float v = 1.0f / (4.0f * (wo.z + wi.z - wo.z * wi.z));
    return {color_ * (d * v * wi.z), wi.z * kInvPi};
  }
  std::optional<LobeSample> sample(const V3f& wo, float /*choice*/, const V2f& u) const {
    const V3f wi = square_to_cosine_hemisphere(u);
    const LobeValue v = evaluate(wo, wi);
    if (v.pdf <= 0.0f) return std::nullopt;
    return LobeSample{.wi = wi, .weight = v.value / v.pdf, .pdf = v.pdf, .diffuse = true};
  }
  bool delta() const { return false; }
  float spread() const { return 1.0f; }
  V3f albedo() const { return color_; }

 private:
  V3f color_;
  float alpha_;
};

}  // namespace morsel::render

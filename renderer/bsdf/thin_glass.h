// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/bsdf/directional_albedo.h"
#include "renderer/bsdf/ggx.h"
#include "renderer/bsdf/lobe.h"

namespace morsel::render {

// A sheet of glass so thin that light leaves it in the direction it came from, blurred when the
// sheet is rough: KHR_materials_transmission without a volume. Both faces reflect, and light
// bounces between them: R' = 2 R / (1 + R), T' = 1 - R'. Light that facets bounce more than once
// leaves evenly to both sides.
class ThinGlass {
 public:
  ThinGlass(const V3f& tint, float alpha, float ior) : tint_(tint), alpha_(alpha), ior_(ior) {}

  LobeValue evaluate(const V3f& wo, const V3f& wi) const;
  std::optional<LobeSample> sample(const V3f& wo, float choice, const V2f& u) const;
  bool delta() const { return alpha_ < Ggx::kSmallestAlpha; }
  float spread() const { return alpha_; }
  V3f albedo() const { return V3f(1.0f); }

 private:
  float reflectance(float cos_theta) const;

  V3f tint_;
  float alpha_, ior_;
};

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/bsdf/lobe.h"
#include "renderer/math/warp.h"

namespace morsel::render {

// Lambert's law: f = albedo / pi.
class Diffuse {
 public:
  explicit Diffuse(const V3f& albedo) : albedo_(albedo) {}

  LobeValue evaluate(const V3f& /*wo*/, const V3f& wi) const {
    if (wi.z <= 0.0f) return {};
    const float pdf = wi.z * kInvPi;
    return {albedo_ * pdf, pdf};
  }
  std::optional<LobeSample> sample(const V3f& /*wo*/, float /*choice*/, const V2f& u) const {
    const V3f wi = square_to_cosine_hemisphere(u);
    if (wi.z <= 0.0f) return std::nullopt;
    return LobeSample{.wi = wi, .weight = albedo_, .pdf = wi.z * kInvPi};
  }
  bool delta() const { return false; }
  float spread() const { return 1.0f; }
  V3f albedo() const { return albedo_; }

 private:
  V3f albedo_;
};

}  // namespace morsel::render

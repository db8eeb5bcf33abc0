// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/bsdf/lobe.h"
#include "renderer/math/warp.h"

namespace morsel::render {

// A matte surface. Without roughness it is Lambert's, f = albedo / pi; with it, Oren and Nayar's
// V-shaped grooves in the form that keeps the albedo at every roughness and angle: J. Portsmouth,
// P. Kutz & S. Hill, "EON: A practical energy-preserving rough diffuse BRDF", JCGT 14(1), 2025
// (Fujii's variant of Oren-Nayar for a single bounce, and a lobe of the form (1 - E)(1 - E) for the
// others).
class Diffuse {
 public:
  // `roughness` in [0, 1].
  explicit Diffuse(const V3f& albedo, float roughness = 0.0f)
      : albedo_(albedo), roughness_(roughness) {}

  LobeValue evaluate(const V3f& wo, const V3f& wi) const {
    if (wi.z <= 0.0f) return {};
    const float pdf = wi.z * kInvPi;
    return {(roughness_ > 0.0f ? rough_albedo(wo, wi) : albedo_) * pdf, pdf};
  }
  std::optional<LobeSample> sample(const V3f& wo, float /*choice*/, const V2f& u) const {
    const V3f wi = square_to_cosine_hemisphere(u);
    if (wi.z <= 0.0f) return std::nullopt;
    return LobeSample{.wi = wi,
                      .weight = roughness_ > 0.0f ? rough_albedo(wo, wi) : albedo_,
                      .pdf = wi.z * kInvPi,
                      .diffuse = true};
  }
  bool delta() const { return false; }
  float spread() const { return 1.0f; }
  V3f albedo() const { return albedo_; }
  float roughness() const { return roughness_; }

 private:
  static constexpr float kA = 0.5f - 2.0f / (3.0f * kPi), kB = 2.0f / 3.0f - 28.0f / (15.0f * kPi);

  // Share that one bounce reflects of white, seen at this cosine: the paper's polynomial fit.
  float single(float cosine) const {
    const float m = 1.0f - cosine;
    const float g =
        m * (0.0571085289f + m * (0.491881867f + m * (-0.332181442f + m * 0.0714429953f)));
    return (1.0f + roughness_ * g) / (1.0f + kA * roughness_);
  }
  // pi * f
  V3f rough_albedo(const V3f& wo, const V3f& wi) const {
    const float s = dot(wi, wo) - wi.z * wo.z;
    const float t = s > 0.0f ? s / std::max(std::max(wi.z, wo.z), 1e-6f) : s;
    const float a = 1.0f / (1.0f + kA * roughness_);
    const float once = a * (1.0f + roughness_ * t);
    const float mean = a * (1.0f + kB * roughness_);
    const float more = std::max(0.0f, 1.0f - single(wo.z)) * std::max(0.0f, 1.0f - single(wi.z)) /
                       std::max(1e-6f, 1.0f - mean);
    V3f value;
    for (int i = 0; i < 3; ++i) {
      const float rho = albedo_[i];
      value[i] = rho * once + rho * rho * mean / (1.0f - rho * (1.0f - mean)) * more;
    }
    return value;
  }

  V3f albedo_;
  float roughness_;
};

}  // namespace morsel::render

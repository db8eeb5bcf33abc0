// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/directional_albedo.h"

#include <array>

#include "renderer/bsdf/ggx.h"
#include "renderer/sampler/owen_sobol.h"

namespace morsel::render {
namespace {

// Cosines are spaced in sqrt(cos): the albedo changes fastest towards grazing angles.
constexpr int kCosines = 32, kAlphas = 24, kSamples = 256;

struct Table {
  std::array<std::array<float, kCosines>, kAlphas> value;

  Table() {
    for (int a = 0; a < kAlphas; ++a) {
      // The first row stands for a mirror.
      const float alpha = static_cast<float>(a) / (kAlphas - 1);
      for (int c = 0; c < kCosines; ++c)
        value[a][c] = a == 0 ? 1.0f : integrate(cosine_of(c), alpha);
    }
  }
  static float cosine_of(int c) {
    return square(std::max(static_cast<float>(c) / (kCosines - 1), 1e-3f));
  }
  // Mean weight of the visible-normal estimator.
  static float integrate(float cos_theta, float alpha) {
    const Ggx ggx(alpha);
    const V3f wo(std::sqrt(1.0f - cos_theta * cos_theta), 0.0f, cos_theta);
    float sum = 0.0f;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      const V2f u((static_cast<float>(i) + 0.5f) / kSamples, to_unit_float(reverse_bits(i)));
      const V3f h = ggx.sample_visible(wo, u);
      const V3f wi = h * (2.0f * dot(wo, h)) - wo;
      if (wi.z > 0.0f) sum += ggx.masking_shadowing(wo, wi) / ggx.masking(wo);
    }
    return sum / kSamples;
  }
};

}  // namespace

float ggx_directional_albedo(float cos_theta, float alpha) {
  static const Table table;
  const float c = std::sqrt(std::clamp(cos_theta, 0.0f, 1.0f)) * (kCosines - 1);
  const float a = std::clamp(alpha, 0.0f, 1.0f) * (kAlphas - 1);
  const int c0 = std::min(static_cast<int>(c), kCosines - 2);
  const int a0 = std::min(static_cast<int>(a), kAlphas - 2);
  const float fc = c - static_cast<float>(c0), fa = a - static_cast<float>(a0);
  const auto& low = table.value[a0];
  const auto& high = table.value[a0 + 1];
  return (1.0f - fa) * ((1.0f - fc) * low[c0] + fc * low[c0 + 1]) +
         fa * ((1.0f - fc) * high[c0] + fc * high[c0 + 1]);
}

}  // namespace morsel::render

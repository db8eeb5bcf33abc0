// SPDX-License-Identifier: Apache-2.0
#include "renderer/image/tone_map.h"

namespace morsel::render {
namespace {

constexpr float kShoulderStart = 0.6f;

float shoulder(float x) {
  if (x <= kShoulderStart) return x;
  const float range = 1.0f - kShoulderStart;
  return kShoulderStart + range * (1.0f - std::exp(-(x - kShoulderStart) / range));
}

// IEC 61966-2-1.
float srgb_encode(float x) {
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}

}  // namespace

V3f tone_map(const V3f& radiance, float exposure) {
  const float gain = std::exp2(exposure);
  V3f c;
  for (int i = 0; i < 3; ++i) c[i] = std::max(0.0f, radiance[i] * gain);
  const float largest = max_component(c);
  const float scale = largest > 0.0f ? shoulder(largest) / largest : 1.0f;
  V3f out;
  for (int i = 0; i < 3; ++i)
    out[i] = srgb_encode(std::clamp(0.5f * (shoulder(c[i]) + c[i] * scale), 0.0f, 1.0f));
  return out;
}

}  // namespace morsel::render

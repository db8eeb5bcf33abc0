// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/light.h"

namespace morsel::render {
namespace {

float angle_between(const V3f& a, const V3f& b) {
  const V3f c = cross(a, b);
  return std::atan2(std::sqrt(dot(c, c)), dot(a, b));
}

}  // namespace

LightBounds LightBounds::join(const LightBounds& a, const LightBounds& b) {
  if (!(a.power > 0.0f)) return b;
  if (!(b.power > 0.0f)) return a;
  LightBounds r;
  for (int i = 0; i < 3; ++i) {
    r.low[i] = std::min(a.low[i], b.low[i]);
    r.high[i] = std::max(a.high[i], b.high[i]);
  }
  r.power = a.power + b.power;
  r.two_sided = a.two_sided || b.two_sided;
  // The smallest cone about both cones.
  const LightBounds &wide = a.spread >= b.spread ? a : b, &narrow = a.spread >= b.spread ? b : a;
  const float between = angle_between(wide.axis, narrow.axis);
  if (between + narrow.spread <= wide.spread) {
    r.axis = wide.axis;
    r.spread = wide.spread;
    return r;
  }
  const float spread = 0.5f * (wide.spread + between + narrow.spread);
  const V3f side = cross(cross(wide.axis, narrow.axis), wide.axis);
  const float length = std::sqrt(dot(side, side));
  if (spread >= kPi || !(length > 1e-6f)) return r;  // any direction
  const float turn = spread - wide.spread;
  r.axis = normalize(wide.axis * std::cos(turn) + side * (std::sin(turn) / length));
  r.spread = std::min(kPi, spread * 1.0001f + 1e-4f);
  return r;
}

float LightBounds::surface_area() const {
  const V3f d = high - low;
  return 2.0f * (d.x * d.y + d.y * d.z + d.z * d.x);
}

// After Conty Estevez & Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting",
// 2018: power, falloff to the middle, and the smallest angle that a normal can make with the way to
// p.
float LightBounds::importance(const V3f& p) const {
  const V3f middle = (low + high) * 0.5f, half = (high - low) * 0.5f;
  const V3f d = p - middle;
  const float distance2 = dot(d, d), radius2 = dot(half, half);
  float cosine = 1.0f;
  if (distance2 > radius2 && spread < kPi) {
    float angle = angle_between(axis, d);
    if (two_sided) angle = std::min(angle, kPi - angle);
    const float size = std::asin(std::sqrt(std::min(1.0f, radius2 / distance2)));
    const float least = angle - spread - size;
    // A margin, since rounding must not make a light invisible to its own importance.
    if (least >= 0.5f * kPi + 1e-3f) return 0.0f;
    cosine = std::max(std::cos(std::max(0.0f, least)), 0.02f);
  }
  return power * cosine / std::max(distance2, std::max(radius2, 1e-20f));
}

}  // namespace morsel::render

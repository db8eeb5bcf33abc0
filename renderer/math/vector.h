// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>

// The few operations on Imath's vectors that the renderer's hot paths need without Imath's
// guards against denormal lengths.
namespace morsel::render {

using Imath::V2f;
using Imath::V3d;
using Imath::V3f;

inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr float kInvPi = 1.0f / kPi;
inline constexpr float kOneMinusEpsilon = 0x1.fffffep-1f;  // the largest float below 1

inline float dot(const V3f& a, const V3f& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline V3f cross(const V3f& a, const V3f& b) { return a.cross(b); }
// `v` must not be zero.
inline V3f normalize(const V3f& v) { return v * (1.0f / std::sqrt(dot(v, v))); }
// Of a vector that is a unit one but for rounding: by the first two terms of the root's series.
inline V3f renormalize(const V3f& v) { return v * (1.5f - 0.5f * dot(v, v)); }
inline float square(float x) { return x * x; }
inline float max_component(const V3f& v) { return std::max(v.x, std::max(v.y, v.z)); }
inline float max_abs(const V3f& v) {
  return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z)));
}
inline bool is_finite(const V3f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Of |x| < 2^31. std::floor is much work where the processor need not have an instruction for it.
inline int floor_of(float x) {
  const int i = static_cast<int>(x);
  return i - (static_cast<float>(i) > x ? 1 : 0);
}

// No light. What is not a number counts as light: it must get where it is found.
inline bool is_black(const V3f& c) { return c.x <= 0.0f && c.y <= 0.0f && c.z <= 0.0f; }

// Relative luminance of a linear Rec. 709 colour.
inline float luminance(const V3f& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "renderer/math/vector.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// Depth of pixels that see nothing: finite, so that differences of images stay finite.
inline constexpr float kFarDepth = 1e10f;

// A colour for each light group; black. (Imath's vectors are not initialised by themselves.)
struct GroupColors : std::array<V3f, kMaxLightGroups> {
  GroupColors() { fill(V3f(0.0f)); }
};

// What one path brings to its pixel.
struct PathSample {
  static constexpr std::uint32_t kAllFinite = 0xffffffffu;

  V3f radiance{0.0f};
  // Where `radiance` stopped being finite: the number of bounces before it, or kAllFinite.
  std::uint32_t non_finite_bounce = kAllFinite;
  GroupColors groups;  // the part of `radiance` of each light group
  float alpha = 0.0f;  // 1: something is there, 0: not
  V3f albedo{0.0f};    // of the first vertex that is not a mirror or clear glass, in [0, 1]
  V3f normal{0.0f};    // there, unit, world space, towards the viewer; 0 when nothing is hit
  // Of the first hit:
  float depth = kFarDepth;                                       // along the camera's axis
  V3f position{0.0f};                                            // in the world
  V3f geometric_normal{0.0f};                                    // unit, towards the viewer
  std::uint32_t instance = 0xffffffffu, material = 0xffffffffu;  // none: a light, or nothing
  float component = 0.0f;  // 1 + id of the hypertexture component, 0 for anything else
  float steps = 0.0f;      // evaluations of hypertexture that the camera's ray took, hit or not
};

// A finished pixel.
struct Pixel {
  V3f color{0.0f};  // mean radiance
  float alpha = 0.0f;
  V3f albedo{0.0f};
  V3f normal{0.0f};    // mean of unit normals: shorter than 1 across edges
  V3f variance{0.0f};  // of `color`: the samples' variance / their number (for independent samples)
  // Means of depths or ids would be of nothing that exists: these are those of the sample nearest
  // to the pixel's centre.
  float depth = kFarDepth;
  float component = 0.0f;
  V3f position{0.0f};
  V3f geometric_normal{0.0f};
  float steps = 0.0f;  // mean
  std::uint32_t samples = 0;
};

}  // namespace morsel::render

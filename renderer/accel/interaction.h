// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "renderer/math/vector.h"

namespace morsel::render {

// Half-open ray; the direction need not be a unit vector, distances are in its lengths.
struct Ray {
  V3f origin;
  V3f direction;
  float tfar = std::numeric_limits<float>::infinity();
  float time = 0.0f;  // of the shutter, [0, 1]
};

// Who asks: bits of the masks by which things are hidden from some of them. Shadow rays see what is
// opaque; what they may pass in part (cut-outs) is met by kCutout rays.
enum class RayKind : std::uint32_t { kCamera = 1u, kBounce = 2u, kShadow = 4u, kCutout = 8u };

inline constexpr std::uint32_t kNoIndex = 0xffffffffu;

// What shading needs of a mesh's vertex, in object space.
struct alignas(32) MeshVertex {
  V3f position{0.0f}, normal{0.0f};  // 0: the mesh has none
  V2f uv{0.0f, 0.0f};                // likewise
};

class InstanceTransform;

// A point of a surface in world space. Either `light` or `instance` is valid.
struct SurfaceInteraction {
  float t = 0.0f;
  float time = 0.0f;  // of the ray
  V3f p{0.0f};
  // Where rays that leave towards the normal's side and away from it start. They are on the true
  // sides of the surface as the intersector sees it, so tnear can be 0: see accel/README.
  V3f spawn_front{0.0f}, spawn_behind{0.0f};
  V3f geometric_normal{0.0f};  // unit, outward: by winding for meshes, -grad F for hypertexture
  V3f shading_normal{0.0f};    // unit, in the hemisphere of geometric_normal
  V2f uv{0.0f, 0.0f};          // the mesh's, or barycentric
  V2f uv1{0.0f, 0.0f};         // the mesh's second set, or `uv`
  V3f vertex_color{1.0f};      // the mesh's, or white
  float vertex_alpha = 1.0f;   // the mesh's, or 1
  // In object space, for what is solid: the point, its unit normal, and the length there of a world
  // length of 1 (of a mean direction).
  V3f object_p{0.0f}, object_normal{0.0f, 1.0f, 0.0f};
  float object_scale = 1.0f;
  float footprint = 0.0f;  // width of the ray's cone, world
  // In [0, 1): textures may take a random part of the footprint, by this; below 0: all of it.
  float texture_random = -1.0f;
  // Of a mesh's triangle that a ray met, and of its instance if that does not move.
  const MeshVertex* corner[3] = {nullptr, nullptr, nullptr};
  const InstanceTransform* transform = nullptr;
  std::uint32_t instance = kNoIndex;
  std::uint32_t geometry = kNoIndex;
  std::uint32_t primitive = kNoIndex;
  std::uint32_t component = kNoIndex;  // of hypertexture
  std::uint32_t material = 0;
  std::uint32_t light =
      kNoIndex;  // local light of LightSet; materials that emit are not lights here

  const V3f& spawn(const V3f& direction) const {
    return dot(direction, geometric_normal) > 0.0f ? spawn_front : spawn_behind;
  }
};

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/accel/interaction.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// How texture coordinates lie on a mesh's surface at a hit, in the world. The tangents are 0 where
// the mesh has no coordinates or they are degenerate.
struct SurfaceFrame {
  V3f u_tangent{0.0f}, v_tangent{0.0f};    // dp/du, dp/dv
  V3f u_gradient{0.0f}, v_gradient{0.0f};  // of u and v, in the surface: the inverse map

  bool valid() const { return dot(u_gradient, u_gradient) > 0.0f; }
};
// Of the mesh's first or second set of coordinates, 0 or 1; the first stands in for the second.
SurfaceFrame surface_frame(const Scene& scene, const SurfaceInteraction& hit, int uv_set = 0);

// The ellipse that a ray's cone of width hit.footprint cuts out of the surface: its half axes.
struct Footprint {
  V3f across, along;
};
Footprint footprint_of(const SurfaceInteraction& hit, const V3f& wo);

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/accel/embree_handles.h"
#include "renderer/accel/interaction.h"
#include "renderer/accel/transform.h"

namespace morsel::geom {
class HypertextureGeometry;
}

namespace morsel::render {

// A committed Embree geometry of the hypertexture's bricks, which must outlive it.
GeometryHandle create_hypertexture_geometry(const Device& device,
                                            const geom::HypertextureGeometry& hypertexture);

std::uint64_t brick_count(const geom::HypertextureGeometry& hypertexture);
// Looks through all components: not for every hit.
std::uint32_t main_component(const geom::HypertextureGeometry& hypertexture);

// Fills in p, spawn points, normals and the component of the hit of `ray` at s.t on `brick`.
void interact_with_hypertexture(const geom::HypertextureGeometry& hypertexture,
                                const InstanceTransform& transform, const Ray& ray,
                                std::uint32_t brick, SurfaceInteraction& interaction);

}  // namespace morsel::render

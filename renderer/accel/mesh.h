// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/accel/embree_handles.h"
#include "renderer/accel/interaction.h"
#include "renderer/accel/transform.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// A committed Embree geometry with copies of the mesh's positions and triangles. Throws
// std::invalid_argument naming `name` for vertex numbers or array sizes that don't fit.
GeometryHandle create_mesh_geometry(const Device& device, const TriangleMesh& mesh,
                                    const std::string& name);

// Fills in p, spawn points, normals and uv of the hit at barycentric (u, v) of a triangle.
void interact_with_mesh(const TriangleMesh& mesh, const InstanceTransform& transform,
                        std::uint32_t triangle, float u, float v, SurfaceInteraction& interaction);

}  // namespace morsel::render

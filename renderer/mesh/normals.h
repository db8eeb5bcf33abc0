// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/scene/scene.h"

namespace morsel::render {

// Unit vertex normals: the mean of the adjacent triangles' normals, each weighted by the angle that
// the triangle has at the vertex (Thuermer and Wuethrich, "Computing vertex normals from polygonal
// facets", 1998), so that the result does not depend on how a polygon was cut into triangles.
// Vertices at the same position share one normal: seams of texture coordinates stay invisible.
// Where the mean vanishes, the normal of one adjacent triangle stands in. `mesh` must be valid.
// With `groups`, one of each vertex, only triangles whose vertices are of the same group share.
std::vector<Imath::V3f> smooth_normals(const TriangleMesh& mesh,
                                       const std::vector<std::uint32_t>& groups = {});

// No surface's normal, but a sign that the vertex is to get the smooth normal of its group.
Imath::V3f group_normal(std::uint32_t group);

// Makes the mesh's normals, if it has any, unit length; zero ones, as real files have them, become
// smooth normals, and those of group_normal() the smooth ones of their groups. `mesh` must be
// valid.
void normalise_normals(TriangleMesh& mesh);

}  // namespace morsel::render

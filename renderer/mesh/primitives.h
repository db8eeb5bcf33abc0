// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/scene/scene.h"

namespace morsel::render {

// Two triangles in the plane y = 0, centred on the origin, facing +y; u along x, v along -z.
// `size` is the extent along x and z.
TriangleMesh make_rectangle(const Imath::V2f& size);

// Latitude-longitude tessellation about the origin with `segments` (>= 4) edges around the equator
// and half as many from pole to pole; exact normals, u about +y, v from the south pole (0) to the
// north pole (1).
TriangleMesh make_sphere(float radius, int segments);

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "renderer/mesh/primitives.h"

#include <cmath>
#include <numbers>

namespace morsel::render {

TriangleMesh make_rectangle(const Imath::V2f& size) {
  const float x = size.x / 2, z = size.y / 2;
  TriangleMesh mesh;
  mesh.positions = {{-x, 0, z}, {x, 0, z}, {x, 0, -z}, {-x, 0, -z}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TriangleMesh make_sphere(float radius, int segments) {
  const int rings = segments / 2;
  TriangleMesh mesh;
  for (int ring = 0; ring <= rings; ++ring) {
    const double v = static_cast<double>(ring) / rings;
    const double latitude = (v - 0.5) * std::numbers::pi;
    // The poles are exact points; sin and cos of pi / 2 are not.
    const bool pole = ring == 0 || ring == rings;
    const double across = pole ? 0.0 : std::cos(latitude);
    for (int segment = 0; segment <= segments; ++segment) {
      const double u = static_cast<double>(segment) / segments;
      const double longitude = 2 * std::numbers::pi * (segment == segments ? 0.0 : u);
      const Imath::V3d normal(across * std::sin(longitude), std::sin(latitude),
                              across * std::cos(longitude));
      mesh.normals.emplace_back(normal);
      mesh.positions.emplace_back(normal * static_cast<double>(radius));
      mesh.uvs.emplace_back(static_cast<float>(u), static_cast<float>(v));
    }
  }
  for (int ring = 0; ring < rings; ++ring)
    for (int segment = 0; segment < segments; ++segment) {
      const int a = ring * (segments + 1) + segment, b = a + 1;
      const int c = b + segments + 1, d = a + segments + 1;
      if (ring > 0) mesh.triangles.emplace_back(a, b, c);
      if (ring < rings - 1) mesh.triangles.emplace_back(a, c, d);
    }
  return mesh;
}

}  // namespace morsel::render

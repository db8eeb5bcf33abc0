// SPDX-License-Identifier: Apache-2.0
#include "renderer/accel/mesh.h"

#include <fmt/format.h>

#include <cstring>
#include <stdexcept>

#include "renderer/accel/spawn.h"

namespace morsel::render {

GeometryHandle create_mesh_geometry(const Device& device, const TriangleMesh& mesh,
                                    const std::string& name) {
  const std::size_t vertices = mesh.positions.size();
  const auto fail = [&](const std::string& what) {
    throw std::invalid_argument(fmt::format("mesh '{}': {}", name, what));
  };
  if (mesh.triangles.empty()) fail("it has no triangles");
  const auto check = [&](const auto& values, const char* what) {
    if (!values.empty() && values.size() != vertices)
      fail(fmt::format("{} {} for {} vertices", values.size(), what, vertices));
  };
  check(mesh.normals, "normals");
  check(mesh.uvs, "texture coordinates");
  check(mesh.uvs1, "second texture coordinates");
  check(mesh.colors, "colors");
  check(mesh.alphas, "alphas");
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Imath::V3i& t = mesh.triangles[i];
    for (int k = 0; k < 3; ++k)
      if (t[k] < 0 || static_cast<std::size_t>(t[k]) >= vertices)
        fail(fmt::format("triangle {} has vertex {} of {}", i, t[k], vertices));
  }

  GeometryHandle geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  void* positions = rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0,
                                            RTC_FORMAT_FLOAT3, sizeof(V3f), vertices);
  void* triangles =
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              sizeof(Imath::V3i), mesh.triangles.size());
  device.check(fmt::format("buffers of mesh '{}'", name));
  // NOLINTBEGIN(bugprone-undefined-memory-manipulation): Imath's vectors are their numbers.
  std::memcpy(positions, mesh.positions.data(), vertices * sizeof(V3f));
  std::memcpy(triangles, mesh.triangles.data(), mesh.triangles.size() * sizeof(Imath::V3i));
  // NOLINTEND(bugprone-undefined-memory-manipulation)
  geom::accept_all_rays(geometry.get());
  rtcCommitGeometry(geometry.get());
  device.check(fmt::format("mesh '{}'", name));
  return geometry;
}

void interact_with_mesh(const TriangleMesh& mesh, const InstanceTransform& transform,
                        std::uint32_t triangle, float u, float v, SurfaceInteraction& s) {
  const Imath::V3i& t = mesh.triangles[triangle];
  const auto i0 = static_cast<std::size_t>(t.x), i1 = static_cast<std::size_t>(t.y),
             i2 = static_cast<std::size_t>(t.z);
  const V3d p0(mesh.positions[i0]), p1(mesh.positions[i1]), p2(mesh.positions[i2]);
  const double b1 = u, b2 = v, b0 = 1.0 - b1 - b2;

  // In double, so that the point is in the triangle's plane to far below a float's rounding.
  const V3d local = p0 * b0 + p1 * b1 + p2 * b2;
  const V3d e1 = p1 - p0, e2 = p2 - p0;
  // As long as twice the triangle's area. One without cannot be hit; should rounding have it
  // otherwise, nothing goes NaN.
  V3d n = e1.cross(e2);
  double area = std::sqrt(n.dot(n));
  if (!(area > 0.0)) [[unlikely]] {
    n = V3d(0.0, 0.0, 1.0);
    area = 1.0;
  }
  const V3d world = transform.point_to_world(local);
  s.p = V3f(world);
  s.object_p = V3f(local);
  s.object_scale = transform.mean_scale();
  double length;  // `area` times what the transform stretches
  const V3d world_normal = transform.normal_to_world(n, length);
  s.geometric_normal = V3f(world_normal);

  // How far off the plane, in object space, Embree may take a ray's origin to be: the transform's
  // error along the normal; its vertices relative to the origin round once; its normal, a cross
  // product in float, is as much worse as the triangle is slim. All of it times `area`.
  const V3d error = transform.object_error(s.p);
  const double from_transform =
      error.x * std::abs(n.x) + error.y * std::abs(n.y) + error.z * std::abs(n.z);
  const double l1 = std::sqrt(e1.dot(e1)), l2 = std::sqrt(e2.dot(e2));
  const double slimness = std::min(100.0 * area, std::max(area, l1 * l2));
  const double magnitude =
      std::max(std::max(max_abs(mesh.positions[i0]), max_abs(mesh.positions[i1])),
               max_abs(mesh.positions[i2]));
  const double off =
      from_transform + 0x1p-24 * (8.0 * std::max(l1, l2) * slimness + 2.0 * magnitude * area);
  set_spawn_points(world, world_normal, off / length, s);

  if (mesh.normals.empty()) {
    s.object_normal = V3f(n / area);
    s.shading_normal = s.geometric_normal;
  } else {
    const auto a = static_cast<float>(b0);
    const V3f mean = mesh.normals[i0] * a + mesh.normals[i1] * u + mesh.normals[i2] * v;
    const float mean2 = dot(mean, mean);
    s.object_normal = mean2 > 0.0f ? mean / std::sqrt(mean2) : V3f(n / area);
    const V3f shading(transform.normal_to_world(V3d(mean)));
    s.shading_normal = s.geometric_normal;
    if (is_finite(shading))
      s.shading_normal = dot(shading, s.geometric_normal) < 0.0f ? -shading : shading;
  }
  const auto interpolated = [&](const auto& values) {
    return values[i0] * static_cast<float>(b0) + values[i1] * u + values[i2] * v;
  };
  s.uv = mesh.uvs.empty() ? V2f(u, v) : interpolated(mesh.uvs);
  s.uv1 = mesh.uvs1.empty() ? s.uv : interpolated(mesh.uvs1);
  if (!mesh.colors.empty()) s.vertex_color = interpolated(mesh.colors);
  if (!mesh.alphas.empty()) s.vertex_alpha = interpolated(mesh.alphas);
}

}  // namespace morsel::render

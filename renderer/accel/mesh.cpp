// SPDX-License-Identifier: Apache-2.0
#include "renderer/accel/mesh.h"

#include <emmintrin.h>
#include <fmt/format.h>

#include <cstring>
#include <stdexcept>

#include "renderer/accel/spawn.h"

namespace morsel::render {
namespace {

// Both square roots in the time of one.
struct Roots {
  double first, second;
};
Roots roots(double a, double b) {
  const __m128d both = _mm_sqrt_pd(_mm_setr_pd(a, b));
  return {_mm_cvtsd_f64(both), _mm_cvtsd_f64(_mm_unpackhi_pd(both, both))};
}

}  // namespace

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

ShadedMesh::ShadedMesh(const TriangleMesh& mesh)
    : mesh_(mesh),
      triangles_(mesh.triangles.data()),
      has_normals_(!mesh.normals.empty()),
      has_uvs_(!mesh.uvs.empty()),
      has_more_(!mesh.uvs1.empty() || !mesh.colors.empty() || !mesh.alphas.empty()),
      vertices_(mesh.positions.size()) {
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    vertices_[i].position = mesh.positions[i];
    if (has_normals_) vertices_[i].normal = mesh.normals[i];
    if (has_uvs_) vertices_[i].uv = mesh.uvs[i];
  }
}

void ShadedMesh::interact(const InstanceTransform& transform, std::uint32_t triangle, float u,
                          float v, SurfaceInteraction& s) const {
  const Imath::V3i& t = triangles_[triangle];
  const MeshVertex &v0 = vertices_[static_cast<std::size_t>(t.x)],
                   &v1 = vertices_[static_cast<std::size_t>(t.y)],
                   &v2 = vertices_[static_cast<std::size_t>(t.z)];
  const V3d p0(v0.position), p1(v1.position), p2(v2.position);
  const double b1 = u, b2 = v, b0 = 1.0 - b1 - b2;
  const auto a = static_cast<float>(b0);

  // In double, so that the point is in the triangle's plane to far below a float's rounding.
  const V3d local = p0 * b0 + p1 * b1 + p2 * b2;
  const V3d e1 = p1 - p0, e2 = p2 - p0;
  // As long as twice the triangle's area. One without cannot be hit; should rounding have it
  // otherwise, nothing goes NaN.
  V3d n = e1.cross(e2);
  double area2 = n.dot(n);
  if (!(area2 > 0.0)) [[unlikely]] {
    n = V3d(0.0, 0.0, 1.0);
    area2 = 1.0;
  }
  const V3f mean = v0.normal * a + v1.normal * u + v2.normal * v;
  const V3d direction = transform.normal_direction(n),
            shading_direction = transform.normal_direction(V3d(mean));
  // `length`: `area` times what the transform stretches.
  const auto [length, shading_length] =
      roots(direction.dot(direction), shading_direction.dot(shading_direction));
  const double per_length = 1.0 / length;
  const V3d world = transform.point_to_world(local);
  const V3d world_normal = direction * per_length;
  s.p = V3f(world);
  s.object_p = V3f(local);
  s.corner[0] = &v0;
  s.corner[1] = &v1;
  s.corner[2] = &v2;
  s.object_scale = transform.mean_scale();
  s.geometric_normal = V3f(world_normal);

  // How far off the plane, in object space, Embree may take a ray's origin to be: the transform's
  // error along the normal; its vertices relative to the origin round once; its normal, a cross
  // product in float, is as much worse as the triangle is slim. All of it times `area`.
  const V3d error = transform.object_error(s.p);
  const double from_transform =
      error.x * std::abs(n.x) + error.y * std::abs(n.y) + error.z * std::abs(n.z);
  const double l1 = e1.dot(e1), l2 = e2.dot(e2);  // squared
  const auto [longest, product] = roots(std::max(l1, l2), l1 * l2);
  const double area = std::sqrt(area2);
  const double slimness = std::min(100.0 * area, std::max(area, product));
  const double magnitude =
      std::max(std::max(max_abs(v0.position), max_abs(v1.position)), max_abs(v2.position));
  const double off = from_transform + 0x1p-24 * (8.0 * longest * slimness + 2.0 * magnitude * area);
  set_spawn_points(world, world_normal, off * per_length, s);

  s.shading_normal = s.geometric_normal;
  const float mean2 = dot(mean, mean);
  if (has_normals_ && mean2 > 0.0f) {
    s.object_normal = mean * (1.0f / std::sqrt(mean2));
    const V3f shading(shading_direction * (1.0 / shading_length));
    if (is_finite(shading))
      s.shading_normal = dot(shading, s.geometric_normal) < 0.0f ? -shading : shading;
  } else {
    s.object_normal = V3f(n * (1.0 / area));
  }
  s.uv = has_uvs_ ? v0.uv * a + v1.uv * u + v2.uv * v : V2f(u, v);
  s.uv1 = s.uv;
  s.vertex_color = V3f(1.0f);
  s.vertex_alpha = 1.0f;
  s.footprint = 0.0f;
  s.texture_random = -1.0f;
  s.transform = &transform;
  s.component = s.light = kNoIndex;
  if (has_more_) interpolate_more(t, a, u, v, s);
}

void ShadedMesh::interpolate_more(const Imath::V3i& t, float b0, float b1, float b2,
                                  SurfaceInteraction& s) const {
  const auto interpolated = [&](const auto& values) {
    return values[static_cast<std::size_t>(t.x)] * b0 + values[static_cast<std::size_t>(t.y)] * b1 +
           values[static_cast<std::size_t>(t.z)] * b2;
  };
  if (!mesh_.uvs1.empty()) s.uv1 = interpolated(mesh_.uvs1);
  if (!mesh_.colors.empty()) s.vertex_color = interpolated(mesh_.colors);
  if (!mesh_.alphas.empty()) s.vertex_alpha = interpolated(mesh_.alphas);
}

}  // namespace morsel::render

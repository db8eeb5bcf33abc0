// SPDX-License-Identifier: Apache-2.0
#include "renderer/material/surface_frame.h"

#include "renderer/accel/transform.h"

namespace morsel::render {

namespace {

// Of two edges of a triangle in the world and what coordinates change along them.
SurfaceFrame frame_of(const V3d& e1, const V3d& e2, const Imath::V2d& a, const Imath::V2d& b) {
  SurfaceFrame frame;
  const double area = a.x * b.y - a.y * b.x;
  const V3d n = e1.cross(e2);
  const double n2 = n.dot(n);
  if (!(std::abs(area) > 0.0) || !(n2 > 0.0)) return frame;
  const double per_area = 1.0 / area, per_n2 = 1.0 / n2;
  frame.u_tangent = V3f((e1 * b.y - e2 * a.y) * per_area);
  frame.v_tangent = V3f((e2 * a.x - e1 * b.x) * per_area);
  // Barycentric coordinates have the gradients e2 x n / n^2 and n x e1 / n^2.
  const V3d g1 = e2.cross(n) * per_n2, g2 = n.cross(e1) * per_n2;
  frame.u_gradient = V3f(g1 * a.x + g2 * b.x);
  frame.v_gradient = V3f(g1 * a.y + g2 * b.y);
  if (!is_finite(frame.u_tangent) || !is_finite(frame.v_tangent) || !is_finite(frame.u_gradient) ||
      !is_finite(frame.v_gradient))
    return {};
  return frame;
}

}  // namespace

SurfaceFrame surface_frame(const Scene& scene, const SurfaceInteraction& hit, int uv_set) {
  if (uv_set == 0 && hit.transform != nullptr && hit.corner[0] != nullptr) {  // all is at hand
    const MeshVertex &v0 = *hit.corner[0], &v1 = *hit.corner[1], &v2 = *hit.corner[2];
    return frame_of(hit.transform->vector_to_world(V3d(v1.position - v0.position)),
                    hit.transform->vector_to_world(V3d(v2.position - v0.position)),
                    Imath::V2d(v1.uv - v0.uv), Imath::V2d(v2.uv - v0.uv));
  }
  const auto* mesh = std::get_if<TriangleMesh>(&scene.geometries[hit.geometry].shape);
  if (mesh == nullptr) return {};
  const std::vector<V2f>& uvs = uv_set == 1 && !mesh->uvs1.empty() ? mesh->uvs1 : mesh->uvs;
  if (uvs.empty()) return {};
  const Imath::V3i& t = mesh->triangles[hit.primitive];
  const auto i0 = static_cast<std::size_t>(t.x), i1 = static_cast<std::size_t>(t.y),
             i2 = static_cast<std::size_t>(t.z);
  V3d e1, e2;
  const Imath::M44d m = scene.instances[hit.instance].to_world(hit.time);
  m.multDirMatrix(V3d(mesh->positions[i1] - mesh->positions[i0]), e1);
  m.multDirMatrix(V3d(mesh->positions[i2] - mesh->positions[i0]), e2);
  return frame_of(e1, e2, Imath::V2d(uvs[i1] - uvs[i0]), Imath::V2d(uvs[i2] - uvs[i0]));
}

Footprint footprint_of(const SurfaceInteraction& hit, const V3f& wo) {
  const V3f& n = hit.geometric_normal;
  const float cosine = dot(wo, n);
  V3f along = wo - n * cosine;  // the way that the cone slides along the surface
  const float length2 = dot(along, along);
  along = length2 > 1e-8f
              ? along * (1.0f / std::sqrt(length2))
              : normalize(std::abs(n.x) < 0.9f ? cross(n, V3f(1, 0, 0)) : cross(n, V3f(0, 1, 0)));
  return {cross(n, along) * hit.footprint,
          along * (hit.footprint / std::max(0.05f, std::abs(cosine)))};
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "renderer/accel/light_geometry.h"

#include <fmt/format.h>

#include "renderer/accel/spawn.h"

namespace morsel::render {
namespace {

RTCGeometry quad(const Device& device, const RectangleLight& light) {
  RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_QUAD);
  auto* corners = static_cast<V3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                            RTC_FORMAT_FLOAT3, sizeof(V3f), 4));
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(unsigned), 1));
  device.check(fmt::format("buffers of rectangle light '{}'", light.name));
  corners[0] = light.corner;
  corners[1] = light.corner + light.edge_u;
  corners[2] = light.corner + light.edge_u + light.edge_v;
  corners[3] = light.corner + light.edge_v;
  for (unsigned i = 0; i < 4; ++i) indices[i] = i;
  return geometry;
}

// A disk with a normal, or a sphere.
RTCGeometry round(const Device& device, RTCGeometryType type, const V3f& centre, float radius,
                  const V3f& normal, const std::string& name) {
  RTCGeometry geometry = rtcNewGeometry(device.get(), type);
  auto* point = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), 1));
  auto* n = type == RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT
                ? static_cast<V3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_NORMAL, 0,
                                                            RTC_FORMAT_FLOAT3, sizeof(V3f), 1))
                : nullptr;
  device.check(fmt::format("buffers of light '{}'", name));
  for (int i = 0; i < 3; ++i) point[i] = centre[i];
  point[3] = radius;
  if (n != nullptr) *n = normal;
  return geometry;
}

}  // namespace

LightGeometry::LightGeometry(const Scene& scene, const Device& device, RTCScene top,
                             unsigned first_id)
    : first_id_(first_id) {
  for (const RectangleLight& l : scene.rectangles)
    add(device, top, quad(device, l), l, l.name,
        {V3f(0.0f), normalize(cross(l.edge_u, l.edge_v)), false,
         max_abs(l.corner) + max_abs(l.edge_u) + max_abs(l.edge_v)});
  for (const DiskLight& l : scene.disks)
    add(device, top,
        round(device, RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT, l.position, l.radius, l.normal,
              l.name),
        l, l.name, {V3f(0.0f), normalize(l.normal), false, max_abs(l.position) + l.radius});
  for (const SphereLight& l : scene.spheres)
    add(device, top,
        round(device, RTC_GEOMETRY_TYPE_SPHERE_POINT, l.position, l.radius, V3f(0.0f), l.name), l,
        l.name, {l.position, V3f(0.0f), true, max_abs(l.position) + l.radius});
}

void LightGeometry::add(const Device& device, RTCScene top, RTCGeometry geometry,
                        const LightFlags& flags, const std::string& name, const Light& light) {
  const GeometryHandle handle(geometry);
  unsigned mask = static_cast<unsigned>(RayKind::kBounce);
  if (flags.visible_to_camera) mask |= static_cast<unsigned>(RayKind::kCamera);
  if (flags.casts_shadow) mask |= static_cast<unsigned>(RayKind::kShadow);
  rtcSetGeometryMask(geometry, mask);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(top, geometry, first_id_ + static_cast<unsigned>(lights_.size()));
  device.check(fmt::format("light '{}'", name));
  lights_.push_back(light);
}

void LightGeometry::interact(const Ray& ray, const RTCHit& hit, SurfaceInteraction& s) const {
  s.light = hit.geomID - first_id_;
  const Light& light = lights_[s.light];
  const V3d p = V3d(ray.origin) + V3d(ray.direction) * static_cast<double>(s.t);
  s.p = V3f(p);
  s.geometric_normal = light.sphere ? normalize(s.p - light.centre) : light.normal;
  s.shading_normal = s.geometric_normal;
  s.uv = V2f(hit.u, hit.v);
  set_spawn_points(p, V3d(s.geometric_normal), 0x1p-20 * (light.magnitude + max_abs(s.p)), s);
}

}  // namespace morsel::render

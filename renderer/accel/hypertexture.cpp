// SPDX-License-Identifier: Apache-2.0
#include "renderer/accel/hypertexture.h"

#include "hypertexture_geom/embree/geometry.h"
#include "hypertexture_geom/embree/ray_surface.h"
#include "renderer/accel/scene_accel.h"

namespace morsel::render {

GeometryHandle create_hypertexture_geometry(const Device& device,
                                            const geom::HypertextureGeometry& hypertexture) {
  GeometryHandle geometry(hypertexture.create(device.get()));
  device.check("hypertexture geometry");
  return geometry;
}

HypertextureCost hypertexture_cost() {
  const geom::RayStatistics& statistics = geom::ray_statistics();
  return {statistics.evaluations, statistics.filtered};
}

std::uint64_t brick_count(const geom::HypertextureGeometry& hypertexture) {
  return hypertexture.statistics().bricks;
}

std::uint32_t main_component(const geom::HypertextureGeometry& hypertexture) {
  return hypertexture.main_component();
}

void interact_with_hypertexture(const geom::HypertextureGeometry& hypertexture,
                                const InstanceTransform& transform, const Ray& ray,
                                std::uint32_t brick, SurfaceInteraction& s) {
  const V3d world = V3d(ray.origin) + V3d(ray.direction) * static_cast<double>(s.t);
  s.p = V3f(world);
  // Embree took the ray's origin and direction to object space in float. Where the ray starts far
  // from what it hits, the origin's error is the larger one. The spawn points will make the same
  // journey once more, and t itself was rounded to float.
  const double error = transform.object_error(s.p).length() +
                       transform.object_error(ray.origin).length() +
                       transform.object_length(0x1p-23 * s.t * max_abs(ray.direction));
  const geom::ShadingPoint point =
      hypertexture.shade(brick, V3f(transform.point_to_object(world)), static_cast<float>(error));
  s.object_p = V3f(transform.point_to_object(world));
  s.object_normal = point.normal;
  s.object_scale = transform.mean_scale();
  s.geometric_normal = V3f(transform.normal_to_world(V3d(point.normal)));
  s.shading_normal = s.geometric_normal;
  s.spawn_front = V3f(transform.point_to_world(V3d(point.spawn_front)));
  s.spawn_behind = V3f(transform.point_to_world(V3d(point.spawn_behind)));
  s.component = point.component;
}

}  // namespace morsel::render

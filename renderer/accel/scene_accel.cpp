// SPDX-License-Identifier: Apache-2.0
#include "renderer/accel/scene_accel.h"

#include <fmt/format.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <stdexcept>
#include <vector>

#include "renderer/accel/embree_handles.h"
#include "renderer/accel/hypertexture.h"
#include "renderer/accel/mesh.h"
#include "renderer/accel/ray_log.h"
#include "renderer/accel/spawn.h"

namespace morsel::render {
namespace {

constexpr auto kCameraBit = static_cast<unsigned>(RayKind::kCamera);
constexpr auto kOtherBit = static_cast<unsigned>(RayKind::kOther);

GeometryHandle create_rectangle_geometry(const Device& device, const RectangleLight& light) {
  GeometryHandle geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_QUAD));
  auto* corners = static_cast<V3f*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX,
                                                            0, RTC_FORMAT_FLOAT3, sizeof(V3f), 4));
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(unsigned), 1));
  device.check(fmt::format("buffers of rectangle light '{}'", light.name));
  corners[0] = light.corner;
  corners[1] = light.corner + light.edge_u;
  corners[2] = light.corner + light.edge_u + light.edge_v;
  corners[3] = light.corner + light.edge_v;
  for (unsigned i = 0; i < 4; ++i) indices[i] = i;
  rtcSetGeometryMask(geometry.get(), light.visible_to_camera ? kCameraBit | kOtherBit : kOtherBit);
  rtcCommitGeometry(geometry.get());
  return geometry;
}

}  // namespace

struct SceneAccel::Impl {
  // What a hit on an instance needs, in one place.
  struct InstanceData {
    const TriangleMesh* mesh;  // or
    const geom::HypertextureGeometry* hypertexture;
    std::uint32_t geometry, material, detached_material, main_component;
    InstanceTransform transform;
  };
  struct LightData {
    V3f normal;
    float magnitude;  // largest coordinate of a corner
  };

  const Scene& scene;
  Device device;
  std::vector<SceneHandle> geometries;
  SceneHandle top;
  std::vector<InstanceData> instances;
  std::vector<LightData> lights;
  Statistics statistics;

  explicit Impl(const Scene& s) : scene(s) {
    geometries.resize(scene.geometries.size());
    top.reset(rtcNewScene(device.get()));
    rtcSetSceneFlags(top.get(), RTC_SCENE_FLAG_ROBUST);
    for (const Instance& i : scene.instances) add_instance(i);
    for (const RectangleLight& l : scene.rectangles) add_light(l);
    rtcCommitScene(top.get());
    device.check("building the acceleration structure of the scene");
  }

  // Geometries are built when the first instance asks: one that nobody uses may be empty.
  RTCScene geometry_scene(std::uint32_t index) {
    if (!geometries[index]) geometries[index] = build(scene.geometries[index]);
    return geometries[index].get();
  }

  SceneHandle build(const Geometry& g) {
    SceneHandle holder(rtcNewScene(device.get()));
    GeometryHandle geometry;
    if (const auto* mesh = std::get_if<TriangleMesh>(&g.shape)) {
      // Robust: no ray slips between two triangles that share an edge. High: spatial splits.
      // Neither means anything for user geometry.
      rtcSetSceneFlags(holder.get(), RTC_SCENE_FLAG_ROBUST);
      rtcSetSceneBuildQuality(holder.get(), RTC_BUILD_QUALITY_HIGH);
      geometry = create_mesh_geometry(device, *mesh, g.name);
      statistics.triangles += mesh->triangles.size();
    } else {
      const auto& hypertexture =
          std::get<std::shared_ptr<const geom::HypertextureGeometry>>(g.shape);
      if (!hypertexture)
        throw std::invalid_argument(fmt::format("geometry '{}' holds no hypertexture", g.name));
      geometry = create_hypertexture_geometry(device, *hypertexture);
      statistics.hypertexture_bricks += brick_count(*hypertexture);
    }
    rtcAttachGeometryByID(holder.get(), geometry.get(), 0);
    rtcCommitScene(holder.get());
    device.check(fmt::format("building the acceleration structure of geometry '{}'", g.name));
    return holder;
  }

  void add_instance(const Instance& i) {
    const auto check = [&](std::uint32_t index, std::size_t count, const char* what) {
      if (index >= count)
        throw std::invalid_argument(
            fmt::format("instance '{}': {} {} of {}", i.name, what, index, count));
    };
    check(i.geometry, scene.geometries.size(), "geometry");
    check(i.material, scene.materials.size(), "material");
    const std::uint32_t detached = i.detached_material.value_or(i.material);
    check(detached, scene.materials.size(), "detached material");

    const auto& shape = scene.geometries[i.geometry].shape;
    const auto* mesh = std::get_if<TriangleMesh>(&shape);
    const geom::HypertextureGeometry* hypertexture = mesh ? nullptr : std::get<1>(shape).get();
    instances.push_back({mesh, hypertexture, i.geometry, i.material, detached,
                         hypertexture ? main_component(*hypertexture) : kNoIndex,
                         InstanceTransform(i.object_to_world, i.name)});

    GeometryHandle geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
    rtcSetGeometryInstancedScene(geometry.get(), geometry_scene(i.geometry));
    rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                            instances.back().transform.columns());
    geom::accept_all_rays(geometry.get());
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(top.get(), geometry.get(), static_cast<unsigned>(instances.size() - 1));
    device.check(fmt::format("instance '{}'", i.name));
  }

  void add_light(const RectangleLight& l) {
    const GeometryHandle geometry = create_rectangle_geometry(device, l);
    rtcAttachGeometryByID(top.get(), geometry.get(),
                          static_cast<unsigned>(instances.size() + lights.size()));
    device.check(fmt::format("rectangle light '{}'", l.name));
    lights.push_back({normalize(cross(l.edge_u, l.edge_v)),
                      max_abs(l.corner) + max_abs(l.edge_u) + max_abs(l.edge_v)});
  }

  void interact(const Ray& ray, const RTCHit& hit, SurfaceInteraction& s) const {
    if (hit.instID[0] == RTC_INVALID_GEOMETRY_ID) {
      s.light = hit.geomID - static_cast<std::uint32_t>(instances.size());
      const LightData& light = lights[s.light];
      const V3d p = V3d(ray.origin) + V3d(ray.direction) * static_cast<double>(s.t);
      s.p = V3f(p);
      s.geometric_normal = s.shading_normal = light.normal;
      s.uv = V2f(hit.u, hit.v);
      set_spawn_points(p, V3d(light.normal), 0x1p-20 * (light.magnitude + max_abs(s.p)), s);
      return;
    }
    s.instance = hit.instID[0];
    s.primitive = hit.primID;
    const InstanceData& i = instances[s.instance];
    s.geometry = i.geometry;
    s.material = i.material;
    if (i.mesh) {
      interact_with_mesh(*i.mesh, i.transform, hit.primID, hit.u, hit.v, s);
    } else {
      interact_with_hypertexture(*i.hypertexture, i.transform, ray, hit.primID, s);
      if (s.component != i.main_component) s.material = i.detached_material;
    }
  }
};

SceneAccel::SceneAccel(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
SceneAccel::~SceneAccel() = default;

bool SceneAccel::intersect(const Ray& ray, RayKind kind, SurfaceInteraction& interaction) const {
  const V3f &o = ray.origin, &d = ray.direction;
  RTCRay query = geom::make_ray(o.x, o.y, o.z, d.x, d.y, d.z, 0.0f, ray.tfar);
  query.mask = static_cast<unsigned>(kind);
  RTCRayHit rayhit = geom::make_ray_hit(query);
  if (RayLog* log = RayLog::active())
    log->add(impl_->top.get(), query,
             kind == RayKind::kCamera ? RayLog::Query::kCoherent : RayLog::Query::kIncoherent);
  geom::intersect1(
      impl_->top.get(), rayhit,
      kind == RayKind::kCamera ? geom::Coherence::kCoherent : geom::Coherence::kIncoherent);
  if (rayhit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  interaction = SurfaceInteraction{};
  interaction.t = rayhit.ray.tfar;
  impl_->interact(ray, rayhit.hit, interaction);
  return true;
}

bool SceneAccel::occluded(const Ray& ray) const {
  const V3f &o = ray.origin, &d = ray.direction;
  RTCRay query = geom::make_ray(o.x, o.y, o.z, d.x, d.y, d.z, 0.0f, ray.tfar);
  query.mask = kOtherBit;
  if (RayLog* log = RayLog::active()) log->add(impl_->top.get(), query, RayLog::Query::kOccluded);
  return geom::occluded1(impl_->top.get(), query);
}

SceneAccel::Statistics SceneAccel::statistics() const {
  Statistics s = impl_->statistics;
  s.bytes = impl_->device.bytes();
  return s;
}

FlushDenormals::FlushDenormals() : saved_(_mm_getcsr()) {
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}
FlushDenormals::~FlushDenormals() { _mm_setcsr(saved_); }

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "renderer/accel/scene_accel.h"

#include <fmt/format.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <bit>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <vector>

#include "renderer/accel/embree_handles.h"
#include "renderer/accel/hypertexture.h"
#include "renderer/accel/light_geometry.h"
#include "renderer/accel/mesh.h"
#include "renderer/accel/ray_log.h"

namespace morsel::render {
namespace {

unsigned mask_of(const Scene& scene, const Instance& i) {
  const auto opaque = [&](std::uint32_t material) { return scene.materials[material].opaque(); };
  const bool solid = opaque(i.material) && opaque(i.detached_material.value_or(i.material));
  unsigned mask = 0;
  if (i.visible_to_camera) mask |= static_cast<unsigned>(RayKind::kCamera);
  if (i.visible_to_bounces) mask |= static_cast<unsigned>(RayKind::kBounce);
  if (i.casts_shadow) mask |= static_cast<unsigned>(solid ? RayKind::kShadow : RayKind::kCutout);
  return mask;
}

// In vectors, as Embree reads it: what was just written in parts makes the processor wait.
RTCRay query_of(const Ray& ray, RayKind kind) {
  const V3f &o = ray.origin, &d = ray.direction;
  RTCRay query;  // aligned to 16 bytes
  static_assert(offsetof(RTCRay, dir_x) == 16 && offsetof(RTCRay, tfar) == 32 &&
                offsetof(RTCRay, tnear) == 12 && offsetof(RTCRay, time) == 28 &&
                offsetof(RTCRay, mask) == 36);
  _mm_store_ps(&query.org_x, _mm_setr_ps(o.x, o.y, o.z, 0.0f));
  _mm_store_ps(&query.dir_x, _mm_setr_ps(d.x, d.y, d.z, ray.time));
  const auto mask = std::bit_cast<float>(static_cast<std::uint32_t>(kind));
  _mm_store_ps(&query.tfar, _mm_setr_ps(ray.tfar, mask, 0.0f, 0.0f));  // id and flags are 0
  return query;
}

}  // namespace

struct SceneAccel::Impl {
  // What a hit on an instance needs, in one place.
  struct InstanceData {
    const TriangleMesh* mesh;  // or
    const geom::HypertextureGeometry* hypertexture;
    std::uint32_t geometry, material, detached_material, main_component;
    InstanceTransform transform;
    bool moves;

    InstanceTransform at(const Instance& instance, float time) const {
      return InstanceTransform(instance.to_world(time), instance.name);
    }
  };
  const Scene& scene;
  Device device;
  std::vector<SceneHandle> geometries;
  SceneHandle top;
  std::vector<InstanceData> instances;
  std::optional<LightGeometry> lights;
  bool cutouts = false;
  Statistics statistics;

  explicit Impl(const Scene& s) : scene(s) {
    geometries.resize(scene.geometries.size());
    top.reset(rtcNewScene(device.get()));
    rtcSetSceneFlags(top.get(), RTC_SCENE_FLAG_ROBUST);
    for (const Instance& i : scene.instances) add_instance(i);
    lights.emplace(scene, device, top.get(), static_cast<unsigned>(instances.size()));
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
                         InstanceTransform(i.object_to_world, i.name),
                         i.object_to_world_end.has_value()});
    if (i.object_to_world_end) check_motion(i, instances.back());

    GeometryHandle geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
    rtcSetGeometryInstancedScene(geometry.get(), geometry_scene(i.geometry));
    if (i.object_to_world_end) rtcSetGeometryTimeStepCount(geometry.get(), 2);
    rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                            instances.back().transform.columns());
    if (i.object_to_world_end)
      rtcSetGeometryTransform(geometry.get(), 1, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                              instances.back().at(i, 1.0f).columns());
    const unsigned mask = mask_of(scene, i);
    cutouts = cutouts || (mask & static_cast<unsigned>(RayKind::kCutout)) != 0;
    rtcSetGeometryMask(geometry.get(), mask);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(top.get(), geometry.get(), static_cast<unsigned>(instances.size() - 1));
    device.check(fmt::format("instance '{}'", i.name));
  }

  // Every transform on the way must be usable: half a turn passes through a flat one.
  static void check_motion(const Instance& i, const InstanceData& data) {
    for (int k = 0; k <= 16; ++k) data.at(i, static_cast<float>(k) / 16.0f);
  }

  void interact(const Ray& ray, const RTCHit& hit, SurfaceInteraction& s) const {
    if (hit.instID[0] == RTC_INVALID_GEOMETRY_ID) {
      lights->interact(ray, hit, s);
      return;
    }
    s.instance = hit.instID[0];
    s.primitive = hit.primID;
    const InstanceData& i = instances[s.instance];
    s.geometry = i.geometry;
    s.material = i.material;
    if (i.moves)
      interact_with_moving(ray, hit, i, s);
    else
      interact_with_instance(ray, hit, i, i.transform, s);
  }

  // Apart, for its transform takes a while to be cleared alone.
  [[gnu::noinline]] void interact_with_moving(const Ray& ray, const RTCHit& hit,
                                              const InstanceData& i, SurfaceInteraction& s) const {
    interact_with_instance(ray, hit, i, i.at(scene.instances[s.instance], ray.time), s);
  }

  static void interact_with_instance(const Ray& ray, const RTCHit& hit, const InstanceData& i,
                                     const InstanceTransform& transform, SurfaceInteraction& s) {
    if (i.mesh) {
      interact_with_mesh(*i.mesh, transform, hit.primID, hit.u, hit.v, s);
    } else {
      interact_with_hypertexture(*i.hypertexture, transform, ray, hit.primID, s);
      if (s.component != i.main_component) s.material = i.detached_material;
    }
  }
};

SceneAccel::SceneAccel(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
SceneAccel::~SceneAccel() = default;

bool SceneAccel::intersect(const Ray& ray, RayKind kind, SurfaceInteraction& interaction) const {
  RTCRayHit rayhit = geom::make_ray_hit(query_of(ray, kind));
  if (RayLog* log = RayLog::active())
    log->add(impl_->top.get(), rayhit.ray,
             kind == RayKind::kCamera ? RayLog::Query::kCoherent : RayLog::Query::kIncoherent);
  geom::intersect1(
      impl_->top.get(), rayhit,
      kind == RayKind::kCamera ? geom::Coherence::kCoherent : geom::Coherence::kIncoherent);
  if (rayhit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  interaction = SurfaceInteraction{};
  interaction.t = rayhit.ray.tfar;
  interaction.time = ray.time;
  impl_->interact(ray, rayhit.hit, interaction);
  return true;
}

bool SceneAccel::occluded(const Ray& ray) const {
  RTCRay query = query_of(ray, RayKind::kShadow);
  if (RayLog* log = RayLog::active()) log->add(impl_->top.get(), query, RayLog::Query::kOccluded);
  return geom::occluded1(impl_->top.get(), query);
}

bool SceneAccel::has_cutouts() const { return impl_->cutouts; }

SceneAccel::Statistics SceneAccel::statistics() const {
  Statistics s = impl_->statistics;
  s.bytes = impl_->device.bytes();
  return s;
}

const char* embree_version() { return RTC_VERSION_STRING; }

FlushDenormals::FlushDenormals() : saved_(_mm_getcsr()) {
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}
FlushDenormals::~FlushDenormals() { _mm_setcsr(saved_); }

}  // namespace morsel::render

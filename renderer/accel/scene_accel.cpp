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
  // What a hit on an instance needs first; all of them should stay in the processor's cache.
  struct InstanceData {
    const ShadedMesh* mesh;  // or
    const geom::HypertextureGeometry* hypertexture;
    std::uint32_t geometry, material, detached_material, main_component;
    bool moves;
  };
  const Scene& scene;
  Device device;
  std::vector<SceneHandle> geometries;
  std::vector<std::unique_ptr<const ShadedMesh>> meshes;  // of the geometries that are built
  SceneHandle top;
  std::vector<InstanceData> instances;
  std::vector<InstanceTransform> transforms;  // of each
  std::optional<LightGeometry> lights;
  bool cutouts = false;
  Statistics statistics;

  explicit Impl(const Scene& s) : scene(s) {
    geometries.resize(scene.geometries.size());
    meshes.resize(scene.geometries.size());
    top.reset(rtcNewScene(device.get()));
    rtcSetSceneFlags(top.get(), RTC_SCENE_FLAG_ROBUST);
    for (const Instance& i : scene.instances) add_instance(i);
    lights.emplace(scene, device, top.get(), static_cast<unsigned>(instances.size()));
    rtcCommitScene(top.get());
    device.check("building the acceleration structure of the scene");
  }

  // Geometries are built when the first instance asks: one that nobody uses may be empty.
  RTCScene geometry_scene(std::uint32_t index) {
    const Geometry& geometry = scene.geometries[index];
    if (!geometries[index]) {
      geometries[index] = build(geometry);
      if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shape))
        meshes[index] = std::make_unique<const ShadedMesh>(*mesh);
    }
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
    RTCScene const instanced = geometry_scene(i.geometry);
    const ShadedMesh* mesh = meshes[i.geometry].get();
    const geom::HypertextureGeometry* hypertexture = mesh ? nullptr : std::get<1>(shape).get();
    instances.push_back({mesh, hypertexture, i.geometry, i.material, detached,
                         hypertexture ? main_component(*hypertexture) : kNoIndex,
                         i.object_to_world_end.has_value()});
    transforms.emplace_back(i.object_to_world, i.name);
    if (i.object_to_world_end) check_motion(i);

    GeometryHandle geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
    rtcSetGeometryInstancedScene(geometry.get(), instanced);
    if (i.object_to_world_end) rtcSetGeometryTimeStepCount(geometry.get(), 2);
    rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                            transforms.back().columns().data());
    if (i.object_to_world_end)
      rtcSetGeometryTransform(geometry.get(), 1, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                              transform_at(i, 1.0f).columns().data());
    const unsigned mask = mask_of(scene, i);
    cutouts = cutouts || (mask & static_cast<unsigned>(RayKind::kCutout)) != 0;
    rtcSetGeometryMask(geometry.get(), mask);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(top.get(), geometry.get(), static_cast<unsigned>(instances.size() - 1));
    device.check(fmt::format("instance '{}'", i.name));
  }

  // Every transform on the way must be usable: half a turn passes through a flat one.
  static void check_motion(const Instance& i) {
    for (int k = 0; k <= 16; ++k) transform_at(i, static_cast<float>(k) / 16.0f);
  }
  static InstanceTransform transform_at(const Instance& i, float time) {
    return InstanceTransform(i.to_world(time), i.name);
  }

  void interact(const Ray& ray, const RTCHit& hit, SurfaceInteraction& s) const {
    if (hit.instID[0] == RTC_INVALID_GEOMETRY_ID) {
      clear(s);
      lights->interact(ray, hit, s);
      return;
    }
    const InstanceData& i = instances[hit.instID[0]];
    if (i.moves)
      interact_with_moving(ray, hit, i, s);
    else
      interact_with_instance(ray, hit, i, transforms[hit.instID[0]], s);
    s.instance = hit.instID[0];
    s.primitive = hit.primID;
    s.geometry = i.geometry;
    const bool detached = i.hypertexture != nullptr && s.component != i.main_component;
    s.material = detached ? i.detached_material : i.material;
  }

  // What is not the ray's. A mesh's hits write all of it.
  static void clear(SurfaceInteraction& s) {
    const float t = s.t, time = s.time;
    s = SurfaceInteraction{};
    s.t = t;
    s.time = time;
  }

  // Apart, for its transform takes a while to be cleared alone.
  [[gnu::noinline]] void interact_with_moving(const Ray& ray, const RTCHit& hit,
                                              const InstanceData& i, SurfaceInteraction& s) const {
    interact_with_instance(ray, hit, i, transform_at(scene.instances[hit.instID[0]], ray.time), s);
    s.transform = nullptr;  // it is gone
  }

  static void interact_with_instance(const Ray& ray, const RTCHit& hit, const InstanceData& i,
                                     const InstanceTransform& transform, SurfaceInteraction& s) {
    if (i.mesh) {
      i.mesh->interact(transform, hit.primID, hit.u, hit.v, s);
    } else {
      clear(s);
      interact_with_hypertexture(*i.hypertexture, transform, ray, hit.primID, s);
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

bool SceneAccel::has_hypertextures() const { return impl_->statistics.hypertexture_bricks > 0; }

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

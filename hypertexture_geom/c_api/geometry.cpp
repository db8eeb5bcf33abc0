// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/geometry.h"

#include <cstddef>

#include "hypertexture_geom/c_api/call.h"
#include "hypertexture_geom/c_api/objects.h"
#include "hypertexture_geom/c_api/watch.h"
#include "topology/components.h"

namespace morsel::c_api {
namespace {

constexpr std::size_t kGeometryOptionsV1 = offsetof(MorselGeometryOptions, solver);
constexpr std::size_t kGeometryInfoV1 = sizeof(MorselGeometryInfo);
constexpr std::size_t kShadingV1 = sizeof(MorselShading);
constexpr std::size_t kDetailV1 = sizeof(MorselDetail);

geom::Solver solver_of(const MorselGeometryOptions& options) {
  switch (options.solver) {
    case MORSEL_SOLVER_MODEL:
      return geom::Solver::kModel;
    case MORSEL_SOLVER_SEGMENT:
      return geom::Solver::kSegment;
    case MORSEL_SOLVER_SPHERE:
      return geom::Solver::kSphere;
    default:
      bad_argument("solver is " + std::to_string(options.solver) +
                   ", none of MORSEL_SOLVER_MODEL, MORSEL_SOLVER_SEGMENT, MORSEL_SOLVER_SPHERE");
  }
}

geom::Membership membership_of(const MorselGeometryOptions& options) {
  switch (options.membership) {
    case MORSEL_MEMBERSHIP_LABELS:
      return geom::Membership::kLabels;
    case MORSEL_MEMBERSHIP_STREAMLINE:
      return geom::Membership::kStreamline;
    case MORSEL_MEMBERSHIP_OFF:
      return geom::Membership::kOff;
    default:
      bad_argument("membership is " + std::to_string(options.membership) +
                   ", none of MORSEL_MEMBERSHIP_LABELS, MORSEL_MEMBERSHIP_STREAMLINE, "
                   "MORSEL_MEMBERSHIP_OFF");
  }
}

// As HypertextureGeometry names them.
std::vector<Phase> phases_of(const geom::GeometryOptions& options) {
  const char* surface = options.solver == geom::Solver::kSphere ? "slopes" : "bricks";
  if (options.membership != geom::Membership::kStreamline) return {{surface, 1.0}};
  return {{surface, 0.4}, {"critical points", 0.4}, {"separatrices", 0.2}};
}

void require_primitive(const geom::HypertextureGeometry& geometry, uint32_t prim_id) {
  const std::uint64_t count = geometry.statistics().bricks;
  if (prim_id >= count)
    bad_argument("prim_id is " + std::to_string(prim_id) + ", of " + std::to_string(count) +
                 " primitives");
}

}  // namespace
}  // namespace morsel::c_api

using namespace morsel::c_api;
using morsel::geom::HypertextureGeometry;

MorselResult morsel_create_geometry(MorselField field, MorselTopology topology,
                                    const MorselGeometryOptions* options,
                                    MorselGeometry* geometry) {
  return call(field, [&] {
    const auto f = shared_object_of<FieldObject>(field);
    const auto t = shared_object_of<TopologyObject>(topology);
    require(geometry, "geometry");
    const MorselGeometryOptions o =
        read_options(options, kGeometryOptionsV1, "MorselGeometryOptions");
    require_zero(o.reserved, "MorselGeometryOptions: reserved");
    if (t->cache->field_hash != f->hypertexture.hash)
      bad_argument("the topology is of the field " + t->cache->field_hash + ", not of " +
                   f->hypertexture.hash);
    if (!(o.far_distance >= 0.0 && o.far_distance <= 1e9))
      bad_argument("far_distance is " + std::to_string(o.far_distance) + ", not within 0 to 1e9");
    require_threads(o.threads);
    morsel::geom::GeometryOptions r;
    r.keep = o.keep ? morsel::topology::KeepRule::parse(o.keep) : f->hypertexture.keep;
    r.solver = solver_of(o);
    r.membership = membership_of(o);
    if (o.far_distance > 0.0) r.far_distance = o.far_distance;
    auto object = std::make_shared<GeometryObject>();
    const morsel::topology::Topology& labels = t->cache->topology;
    object->kept =
        r.membership == morsel::geom::Membership::kOff
            ? std::vector<bool>(labels.components.size(), true)
            : morsel::topology::kept_components(r.keep, labels.components, labels.octree());
    Watch watch(o, phases_of(r));
    const morsel::topology::Execution execution = watch.execution();
    on_threads(o.threads, [&] {
      object->geometry =
          std::make_unique<HypertextureGeometry>(f->hypertexture.field, t->cache, r, execution);
    });
    watch.finish();
    give(std::move(object), geometry);
  });
}

MorselResult morsel_retain_geometry(MorselGeometry geometry) {
  return call(geometry, [&] { retain(geometry, Kind::kGeometry); });
}

MorselResult morsel_release_geometry(MorselGeometry geometry) {
  return call(geometry, [&] { release(geometry, Kind::kGeometry); });
}

MorselResult morsel_geometry_info(MorselGeometry geometry, MorselGeometryInfo* info) {
  return call(geometry, [&] {
    const auto& object = object_of<GeometryObject>(geometry);
    require(info, "info");
    const HypertextureGeometry& g = *object.geometry;
    const morsel::geom::GeometryStatistics s = g.statistics();
    MorselGeometryInfo r{};
    r.primitives = s.bricks;
    r.bytes = s.bytes;
    r.step_limits = s.limits;
    store(g.bounds().min, r.lower);
    store(g.bounds().max, r.upper);
    r.padding = g.bounds_padding();
    for (const bool kept : object.kept) r.kept_components += kept;
    r.main_component = object.kept.empty() ? MORSEL_NO_COMPONENT : g.main_component();
    write_struct(r, info, kGeometryInfoV1, "MorselGeometryInfo");
  });
}

MorselResult morsel_geometry_keeps(MorselGeometry geometry, uint32_t component, int32_t* kept) {
  return call(geometry, [&] {
    const auto& object = object_of<GeometryObject>(geometry);
    require(kept, "kept");
    if (component >= object.kept.size())
      bad_argument("component is " + std::to_string(component) + ", of " +
                   std::to_string(object.kept.size()));
    *kept = object.kept[component];
  });
}

MorselResult morsel_geometry_component(MorselGeometry geometry, uint32_t prim_id,
                                       uint32_t* component) {
  return call(geometry, [&] {
    const HypertextureGeometry& g = *object_of<GeometryObject>(geometry).geometry;
    require(component, "component");
    require_primitive(g, prim_id);
    *component = g.component(prim_id);
  });
}

MorselResult morsel_create_rtc_geometry(MorselGeometry geometry, struct RTCDeviceTy* device,
                                        uint32_t flags, struct RTCGeometryTy** rtc_geometry) {
  return call(geometry, [&] {
    const HypertextureGeometry& g = *object_of<GeometryObject>(geometry).geometry;
    require(device, "device");
    require(rtc_geometry, "rtc_geometry");
    if (flags & ~MORSEL_RTC_OCCLUSION_FILTER)
      bad_argument("flags are " + std::to_string(flags) + "; known is 1, the occlusion filter");
    try {
      *rtc_geometry =
          g.create(device, {.occlusion_filter = (flags & MORSEL_RTC_OCCLUSION_FILTER) != 0});
    } catch (const std::runtime_error& e) {
      throw ApiError(MORSEL_ERROR_EMBREE, e.what());
    }
  });
}

MorselResult morsel_shade(MorselGeometry geometry, uint32_t prim_id, const float point[3],
                          float extra_error, MorselShading* shading) {
  return call(geometry, [&] {
    const HypertextureGeometry& g = *object_of<GeometryObject>(geometry).geometry;
    require(point, "point");
    require(shading, "shading");
    require_primitive(g, prim_id);
    require_point(point, "point");
    if (!(extra_error >= 0.0f && extra_error <= 1e9f))
      bad_argument("extra_error is " + std::to_string(extra_error) + ", not within 0 to 1e9");
    const morsel::geom::ShadingPoint s =
        g.shade(prim_id, {point[0], point[1], point[2]}, extra_error);
    MorselShading r{};
    store(s.normal, r.normal);
    store(s.spawn_front, r.spawn_front);
    store(s.spawn_behind, r.spawn_behind);
    r.component = s.component;
    r.spawn_verified = s.spawn_verified;
    store(s.position, r.position);
    r.position_error = s.position_error;
    write_struct(r, shading, kShadingV1, "MorselShading");
  });
}

MorselResult morsel_shade_detail(MorselGeometry geometry, uint32_t prim_id, const double point[3],
                                 MorselDetail* detail) {
  return call(geometry, [&] {
    const HypertextureGeometry& g = *object_of<GeometryObject>(geometry).geometry;
    require(point, "point");
    require(detail, "detail");
    require_primitive(g, prim_id);
    require_point(point, "point");
    const morsel::geom::SurfaceDetail d = g.detail(prim_id, {point[0], point[1], point[2]});
    MorselDetail r{};
    r.density = d.density;
    r.noise = d.noise;
    store(d.reference, r.reference);
    store(d.gradient, r.gradient);
    r.mean_curvature = d.curvature.mean;
    r.gaussian_curvature = d.curvature.gaussian;
    r.component = d.component;
    write_struct(r, detail, kDetailV1, "MorselDetail");
  });
}

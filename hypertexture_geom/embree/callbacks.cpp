// SPDX-License-Identifier: Apache-2.0
// Thin shims between Embree's packets and BrickSurface: nothing here knows how a root is found.
#include "hypertexture_geom/embree/callbacks.h"

#include <cmath>
#include <limits>

namespace morsel::geom {
namespace {

const CallbackData& data_of(const void* user) { return *static_cast<const CallbackData*>(user); }

float below(double x) {
  const auto f = static_cast<float>(x);
  return f <= x ? f : std::nextafter(f, -std::numeric_limits<float>::infinity());
}
float above(double x) { return -below(-x); }

void bounds_callback(const RTCBoundsFunctionArguments* arguments) noexcept {
  const CallbackData& data = data_of(arguments->geometryUserPtr);
  const BrickSet& bricks = data.surface->bricks();
  const topology::Box box = bricks.surface_box(bricks[arguments->primID]);
  RTCBounds& b = *arguments->bounds_o;
  b.lower_x = below(box.min.x - data.padding);
  b.lower_y = below(box.min.y - data.padding);
  b.lower_z = below(box.min.z - data.padding);
  b.upper_x = above(box.max.x + data.padding);
  b.upper_y = above(box.max.y + data.padding);
  b.upper_z = above(box.max.z + data.padding);
}

RaySegment segment_of(RTCRayN* rays, unsigned n, unsigned i) {
  return {{RTCRayN_org_x(rays, n, i), RTCRayN_org_y(rays, n, i), RTCRayN_org_z(rays, n, i)},
          {RTCRayN_dir_x(rays, n, i), RTCRayN_dir_y(rays, n, i), RTCRayN_dir_z(rays, n, i)},
          RTCRayN_tnear(rays, n, i),
          RTCRayN_tfar(rays, n, i)};
}

// Calls accept(t, hit) for the roots in order until it returns true. The hit is complete; `t` is in
// (tnear, tfar) also after rounding.
template <class Accept>
void for_each_root(const BrickSurface& surface, std::uint32_t brick, unsigned geom_id,
                   const RayQueryContext* context, RaySegment segment, const Accept& accept) {
  const auto tnear = static_cast<float>(segment.tnear), tfar = static_cast<float>(segment.tfar);
  BrickSurface::Root root;
  while (surface.first_root(brick, segment, root)) {
    float t = static_cast<float>(root.t);
    if (t <= tnear) t = std::nextafter(tnear, std::numeric_limits<float>::infinity());
    if (t >= tfar) return;
    const Imath::V3d gradient = surface.gradient(brick, segment, root);
    RTCHit hit;
    hit.Ng_x = static_cast<float>(-gradient.x);
    hit.Ng_y = static_cast<float>(-gradient.y);
    hit.Ng_z = static_cast<float>(-gradient.z);
    hit.u = hit.v = 0.0f;
    hit.primID = brick;
    hit.geomID = geom_id;
    copy_instance(context, reinterpret_cast<RTCHitN*>(&hit), 1, 0);
    if (accept(t, hit)) return;
    segment.tnear = root.beyond;
  }
}

// Whether the filters accept a hit of lane `i` at `t`. `run` calls Embree's filter function; it
// sees one lane, with the hit distance in the ray.
template <class Arguments, class Run>
bool accepted(const Arguments* arguments, RTCRayN* rays, unsigned i, float t, RTCHit& hit,
              const Run& run) {
  RTCRay ray = rtcGetRayFromRayN(rays, arguments->N, i);
  ray.tfar = t;
  int valid = -1;
  RTCFilterFunctionNArguments filter;
  filter.valid = &valid;
  filter.geometryUserPtr = arguments->geometryUserPtr;
  filter.context = arguments->context;
  filter.ray = reinterpret_cast<RTCRayN*>(&ray);
  filter.hit = reinterpret_cast<RTCHitN*>(&hit);
  filter.N = 1;
  run(arguments, &filter);
  return valid != 0;
}

void intersect_callback(const RTCIntersectFunctionNArguments* arguments) noexcept {
  const BrickSurface& surface = *data_of(arguments->geometryUserPtr).surface;
  const unsigned n = arguments->N;
  RTCRayN* rays = RTCRayHitN_RayN(arguments->rayhit, n);
  RTCHitN* hits = RTCRayHitN_HitN(arguments->rayhit, n);
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0) continue;
    const auto accept = [&](float t, RTCHit& hit) {
      if (!accepted(arguments, rays, i, t, hit, run_intersect_filter)) return false;
      RTCRayN_tfar(rays, n, i) = t;
      rtcCopyHitToHitN(hits, &hit, n, i);
      copy_instance(arguments->context, hits, n, i);
      return true;
    };
    for_each_root(surface, arguments->primID, arguments->geomID, arguments->context,
                  segment_of(rays, n, i), accept);
  }
}

constexpr float kOccluded = -std::numeric_limits<float>::infinity();

void occluded_callback(const RTCOccludedFunctionNArguments* arguments) noexcept {
  const BrickSurface& surface = *data_of(arguments->geometryUserPtr).surface;
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0) continue;
    if (surface.any_root(arguments->primID, segment_of(arguments->ray, n, i)))
      RTCRayN_tfar(arguments->ray, n, i) = kOccluded;
  }
}

void filtered_occluded_callback(const RTCOccludedFunctionNArguments* arguments) noexcept {
  const BrickSurface& surface = *data_of(arguments->geometryUserPtr).surface;
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0) continue;
    const auto accept = [&](float t, RTCHit& hit) {
      if (!accepted(arguments, arguments->ray, i, t, hit, run_occluded_filter)) return false;
      RTCRayN_tfar(arguments->ray, n, i) = kOccluded;
      return true;
    };
    for_each_root(surface, arguments->primID, arguments->geomID, arguments->context,
                  segment_of(arguments->ray, n, i), accept);
  }
}

}  // namespace

void set_callbacks(RTCGeometry geometry, const CallbackData* data, bool occlusion_filter) {
  rtcSetGeometryUserData(geometry, const_cast<CallbackData*>(data));
  rtcSetGeometryUserPrimitiveCount(geometry, data->surface->bricks().size());
  rtcSetGeometryBoundsFunction(geometry, bounds_callback, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect_callback);
  rtcSetGeometryOccludedFunction(geometry,
                                 occlusion_filter ? filtered_occluded_callback : occluded_callback);
}

}  // namespace morsel::geom

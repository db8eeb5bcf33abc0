// SPDX-License-Identifier: Apache-2.0
// Thin shims between Embree's packets and RaySurface: nothing here knows how a root is found.
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
  const topology::Box box = data.surface->bounds(arguments->primID);
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

// How the two kinds of query differ: where the rays are, which filter runs, what a hit writes.
struct Intersection {
  using Arguments = RTCIntersectFunctionNArguments;
  static RTCRayN* rays(const Arguments* a) { return RTCRayHitN_RayN(a->rayhit, a->N); }
  static void filter(const Arguments* a, const RTCFilterFunctionNArguments* f) {
    run_intersect_filter(a, f);
  }
  static void accept(const Arguments* a, unsigned i, float t, RTCHit& hit) {
    RTCHitN* hits = RTCRayHitN_HitN(a->rayhit, a->N);
    RTCRayN_tfar(rays(a), a->N, i) = t;
    rtcCopyHitToHitN(hits, &hit, a->N, i);
    copy_instance(a->context, hits, a->N, i);
  }
};
struct Occlusion {
  using Arguments = RTCOccludedFunctionNArguments;
  static RTCRayN* rays(const Arguments* a) { return a->ray; }
  static void filter(const Arguments* a, const RTCFilterFunctionNArguments* f) {
    run_occluded_filter(a, f);
  }
  static void accept(const Arguments* a, unsigned i) {
    RTCRayN_tfar(a->ray, a->N, i) = -std::numeric_limits<float>::infinity();
  }
  static void accept(const Arguments* a, unsigned i, float, RTCHit&) { accept(a, i); }
};

// The roots of lane `i`, in order, until the filters accept one. A filter sees one lane, with the
// hit distance in the ray; that distance is in (tnear, tfar) also after rounding.
template <class Query>
void first_accepted(const typename Query::Arguments* a, unsigned i) {
  const RaySurface& surface = *data_of(a->geometryUserPtr).surface;
  RTCRayN* rays = Query::rays(a);
  RaySegment segment = segment_of(rays, a->N, i);
  const auto tnear = static_cast<float>(segment.tnear), tfar = static_cast<float>(segment.tfar);
  RaySurface::Root root;
  while (surface.first_root(a->primID, segment, root)) {
    float t = static_cast<float>(root.t);
    if (t <= tnear) t = std::nextafter(tnear, std::numeric_limits<float>::infinity());
    if (t >= tfar) return;
    const Imath::V3d gradient = surface.gradient(a->primID, segment, root);
    RTCHit hit;
    hit.Ng_x = static_cast<float>(-gradient.x);
    hit.Ng_y = static_cast<float>(-gradient.y);
    hit.Ng_z = static_cast<float>(-gradient.z);
    hit.u = hit.v = 0.0f;
    hit.primID = a->primID;
    hit.geomID = a->geomID;
    copy_instance(a->context, reinterpret_cast<RTCHitN*>(&hit), 1, 0);

    RTCRay ray = rtcGetRayFromRayN(rays, a->N, i);
    ray.tfar = t;
    int valid = -1;
    RTCFilterFunctionNArguments filter;
    filter.valid = &valid;
    filter.geometryUserPtr = a->geometryUserPtr;
    filter.context = a->context;
    filter.ray = reinterpret_cast<RTCRayN*>(&ray);
    filter.hit = reinterpret_cast<RTCHitN*>(&hit);
    filter.N = 1;
    Query::filter(a, &filter);
    if (valid != 0) {
      Query::accept(a, i, t, hit);
      return;
    }
    segment.tnear = root.beyond;
  }
}

void any_hit(const RTCOccludedFunctionNArguments* a, unsigned i) {
  if (has_query_filter(a->context)) return first_accepted<Occlusion>(a, i);
  const RaySurface& surface = *data_of(a->geometryUserPtr).surface;
  if (surface.any_root(a->primID, segment_of(a->ray, a->N, i))) Occlusion::accept(a, i);
}

// A packet of any width: trace(arguments, lane) for its active lanes.
template <class Arguments, void trace(const Arguments*, unsigned)>
void each_lane(const Arguments* arguments) noexcept {
  for (unsigned i = 0; i < arguments->N; ++i)
    if (arguments->valid[i] != 0) trace(arguments, i);
}

}  // namespace

void set_callbacks(RTCGeometry geometry, const CallbackData* data, bool occlusion_filter) {
  rtcSetGeometryUserData(geometry, const_cast<CallbackData*>(data));
  rtcSetGeometryUserPrimitiveCount(geometry, data->surface->size());
  rtcSetGeometryBoundsFunction(geometry, bounds_callback, nullptr);
  rtcSetGeometryIntersectFunction(
      geometry, each_lane<RTCIntersectFunctionNArguments, first_accepted<Intersection>>);
  rtcSetGeometryOccludedFunction(
      geometry, occlusion_filter
                    ? each_lane<RTCOccludedFunctionNArguments, first_accepted<Occlusion>>
                    : each_lane<RTCOccludedFunctionNArguments, any_hit>);
}

}  // namespace morsel::geom

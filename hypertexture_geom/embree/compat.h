// SPDX-License-Identifier: Apache-2.0
#pragma once

// The one place that includes Embree's headers and knows how 3.13 and 4.x differ: names of the
// context, where flags and filters travel, how a callback runs filters, instance arrays, default
// masks. Everything else of the API is spelled alike in both and used directly.

#include <limits>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace morsel::geom {

#if RTC_VERSION_MAJOR >= 4
using RayQueryContext = RTCRayQueryContext;
#else
using RayQueryContext = RTCIntersectContext;
#endif

// A hint to the traversal; never changes a result.
enum class Coherence { kIncoherent, kCoherent };

// Embree 3 accepts every ray by default, Embree 4 only those with bit 0 set: set it always.
inline void accept_all_rays(RTCGeometry geometry) { rtcSetGeometryMask(geometry, 0xffffffffu); }

// A ray that starts at (ox, oy, oz) and goes along (dx, dy, dz), of any length, with no hit yet,
// time 0 and every mask bit set. A hit has t in (tnear, tfar).
inline RTCRay make_ray(float ox, float oy, float oz, float dx, float dy, float dz,
                       float tnear = 0.0f, float tfar = std::numeric_limits<float>::infinity()) {
  RTCRay ray;
  ray.org_x = ox;
  ray.org_y = oy;
  ray.org_z = oz;
  ray.tnear = tnear;
  ray.dir_x = dx;
  ray.dir_y = dy;
  ray.dir_z = dz;
  ray.time = 0.0f;
  ray.tfar = tfar;
  ray.mask = 0xffffffffu;
  ray.id = 0;
  ray.flags = 0;
  return ray;
}

// The ray with an empty hit: geomID and instID[0] are RTC_INVALID_GEOMETRY_ID until one is found.
inline RTCRayHit make_ray_hit(const RTCRay& ray) {
  RTCRayHit rayhit;
  rayhit.ray = ray;
  rayhit.hit.Ng_x = rayhit.hit.Ng_y = rayhit.hit.Ng_z = 0.0f;
  rayhit.hit.u = rayhit.hit.v = 0.0f;
  rayhit.hit.primID = RTC_INVALID_GEOMETRY_ID;
  rayhit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  for (unsigned level = 0; level < RTC_MAX_INSTANCE_LEVEL_COUNT; ++level) {
    rayhit.hit.instID[level] = RTC_INVALID_GEOMETRY_ID;
#ifdef RTC_GEOMETRY_INSTANCE_ARRAY
    rayhit.hit.instPrimID[level] = RTC_INVALID_GEOMETRY_ID;
#endif
  }
  return rayhit;
}

// Whether Embree takes the ray: Debian's builds keep their asserts, and one ray with a NaN, an
// infinity (but for tfar), an absurd coordinate or a negative tnear ends the process.
inline bool is_traceable(const RTCRay& ray) {
  constexpr float kLarge = 1.8e18f;  // Embree's own limit is 1.844e18
  const auto is_small = [](float x) { return x >= -kLarge && x <= kLarge; };
  return is_small(ray.org_x) && is_small(ray.org_y) && is_small(ray.org_z) && is_small(ray.dir_x) &&
         is_small(ray.dir_y) && is_small(ray.dir_z) && ray.tnear >= 0.0f && ray.tnear <= ray.tfar;
}

// First hit of `rayhit.ray`: sets ray.tfar and hit. `rayhit.hit.geomID` must be invalid on entry
// (make_ray_hit sees to that). A ray that is not traceable hits nothing.
inline void intersect1(RTCScene scene, RTCRayHit& rayhit,
                       Coherence coherence = Coherence::kIncoherent) {
  if (!is_traceable(rayhit.ray)) return;
#if RTC_VERSION_MAJOR >= 4
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  if (coherence == Coherence::kCoherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect1(scene, &rayhit, &arguments);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (coherence == Coherence::kCoherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect1(scene, &context, &rayhit);
#endif
}

// The same with a context that the callbacks see: the first member of a struct of the caller's.
inline void intersect1(RTCScene scene, RTCRayHit& rayhit, RayQueryContext& context) {
  if (!is_traceable(rayhit.ray)) return;
#if RTC_VERSION_MAJOR >= 4
  rtcInitRayQueryContext(&context);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &context;
  rtcIntersect1(scene, &rayhit, &arguments);
#else
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &rayhit);
#endif
}

// Whether anything is hit: sets ray.tfar to -infinity if so, and returns it.
inline bool occluded1(RTCScene scene, RTCRay& ray, Coherence coherence = Coherence::kIncoherent) {
  if (!is_traceable(ray)) return false;
#if RTC_VERSION_MAJOR >= 4
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  if (coherence == Coherence::kCoherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcOccluded1(scene, &ray, &arguments);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (coherence == Coherence::kCoherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded1(scene, &context, &ray);
#endif
  return ray.tfar < 0.0f;
}

// While it lives, inactive lanes of a packet have an interval without a number in it. A processor
// without registers as wide as the packet has Embree take the lanes one by one, and it then looks
// at the interval alone and not at `valid`.
template <class RayN, int N>
class EmptyInactiveLanes {
 public:
  EmptyInactiveLanes(const int* valid, RayN& ray) : valid_(valid), ray_(ray) {
    for (int i = 0; i < N; ++i) {
      if (valid_[i] != 0) continue;
      tnear_[i] = ray_.tnear[i];
      tfar_[i] = ray_.tfar[i];
      ray_.tnear[i] = 1.0f;
      ray_.tfar[i] = 0.0f;
    }
  }
  ~EmptyInactiveLanes() {
    for (int i = 0; i < N; ++i) {
      if (valid_[i] != 0) continue;
      ray_.tnear[i] = tnear_[i];
      ray_.tfar[i] = tfar_[i];
    }
  }
  EmptyInactiveLanes(const EmptyInactiveLanes&) = delete;
  EmptyInactiveLanes& operator=(const EmptyInactiveLanes&) = delete;

 private:
  const int* valid_;
  RayN& ray_;
  float tnear_[N], tfar_[N];
};

// Packets of 4, 8 and 16; valid[i] is -1 for an active lane and 0 for one to leave alone. Active
// rays must be traceable.
inline void intersect_packet(const int* valid, RTCScene scene, RTCRayHit4& rayhit) {
#if RTC_VERSION_MAJOR >= 4
  rtcIntersect4(valid, scene, &rayhit, nullptr);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect4(valid, scene, &context, &rayhit);
#endif
}
inline void occluded_packet(const int* valid, RTCScene scene, RTCRay4& ray) {
#if RTC_VERSION_MAJOR >= 4
  rtcOccluded4(valid, scene, &ray, nullptr);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded4(valid, scene, &context, &ray);
#endif
}
inline void intersect_packet(const int* valid, RTCScene scene, RTCRayHit16& rayhit) {
  const EmptyInactiveLanes<RTCRay16, 16> lanes(valid, rayhit.ray);
#if RTC_VERSION_MAJOR >= 4
  rtcIntersect16(valid, scene, &rayhit, nullptr);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect16(valid, scene, &context, &rayhit);
#endif
}
inline void occluded_packet(const int* valid, RTCScene scene, RTCRay16& ray) {
  const EmptyInactiveLanes<RTCRay16, 16> lanes(valid, ray);
#if RTC_VERSION_MAJOR >= 4
  rtcOccluded16(valid, scene, &ray, nullptr);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded16(valid, scene, &context, &ray);
#endif
}
inline void intersect_packet(const int* valid, RTCScene scene, RTCRayHit8& rayhit) {
  const EmptyInactiveLanes<RTCRay8, 8> lanes(valid, rayhit.ray);
#if RTC_VERSION_MAJOR >= 4
  rtcIntersect8(valid, scene, &rayhit, nullptr);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect8(valid, scene, &context, &rayhit);
#endif
}
inline void occluded_packet(const int* valid, RTCScene scene, RTCRay8& ray) {
  const EmptyInactiveLanes<RTCRay8, 8> lanes(valid, ray);
#if RTC_VERSION_MAJOR >= 4
  rtcOccluded8(valid, scene, &ray, nullptr);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded8(valid, scene, &context, &ray);
#endif
}

// In a callback: copies the instance stack of the query into the hit of lane `lane`.
inline void copy_instance(const RayQueryContext* context, RTCHitN* hit, unsigned n, unsigned lane) {
  for (unsigned level = 0; level < RTC_MAX_INSTANCE_LEVEL_COUNT; ++level) {
    RTCHitN_instID(hit, n, lane, level) = context->instID[level];
#ifdef RTC_GEOMETRY_INSTANCE_ARRAY
    RTCHitN_instPrimID(hit, n, lane, level) = context->instPrimID[level];
#endif
  }
}

// Whether the query has a filter of its own that run_occluded_filter runs. Embree 4 passes none to
// callbacks: a filter in RTCIntersectArguments or RTCOccludedArguments is not run on user geometry.
inline bool has_query_filter([[maybe_unused]] const RayQueryContext* context) {
#if RTC_VERSION_MAJOR >= 4
  return false;
#else
  return context != nullptr && context->filter != nullptr;
#endif
}

// In a callback: runs the geometry's filter function, which clears filter->valid[i] to reject, and
// that of the query (see has_query_filter).
inline void run_intersect_filter(const RTCIntersectFunctionNArguments* arguments,
                                 const RTCFilterFunctionNArguments* filter) {
#if RTC_VERSION_MAJOR >= 4
  rtcInvokeIntersectFilterFromGeometry(arguments, filter);
#else
  rtcFilterIntersection(arguments, filter);
#endif
}
inline void run_occluded_filter(const RTCOccludedFunctionNArguments* arguments,
                                const RTCFilterFunctionNArguments* filter) {
#if RTC_VERSION_MAJOR >= 4
  rtcInvokeOccludedFilterFromGeometry(arguments, filter);
#else
  rtcFilterOcclusion(arguments, filter);
#endif
}

}  // namespace morsel::geom

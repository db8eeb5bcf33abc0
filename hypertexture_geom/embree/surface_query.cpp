// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/surface_query.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace morsel::geom {
namespace {

// A query's context, which Embree hands through to the callback: the bricks that the ray may meet.
struct CollectingContext {
  RayQueryContext base;  // first, so that Embree's pointer is ours
  std::vector<std::uint32_t>* bricks;
};

// Notes the brick and reports no hit, so that traversal goes on through all of them.
void collect_callback(const RTCIntersectFunctionNArguments* arguments) noexcept {
  auto* context = reinterpret_cast<CollectingContext*>(arguments->context);
  try {
    context->bricks->push_back(arguments->primID);
  } catch (...) {
    // Out of memory within Embree's traversal, which no exception may cross: the query sees a null
    // and throws.
    context->bricks = nullptr;
  }
}

RTCRay ray_of(const Imath::V3f& o, const Imath::V3f& d, float tnear, float tfar) {
  return make_ray(o.x, o.y, o.z, d.x, d.y, d.z, tnear, tfar);
}

}  // namespace

struct SurfaceQuery::Impl {
  const HypertextureGeometry& geometry;
  RTCScene scene;

  Impl(const HypertextureGeometry& g, RTCDevice device) : geometry(g), scene(nullptr) {
    // What went wrong before, elsewhere on the device, is no failure of this scene.
    rtcGetDeviceError(device);
    scene = rtcNewScene(device);
    RTCGeometry bricks = geometry.create(device);
    rtcSetGeometryIntersectFunction(bricks, collect_callback);
    rtcCommitGeometry(bricks);
    rtcAttachGeometry(scene, bricks);
    rtcReleaseGeometry(bricks);
    rtcCommitScene(scene);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) {
      rtcReleaseScene(scene);
      throw std::runtime_error("Embree could not build the scene of a surface query");
    }
  }
  ~Impl() { rtcReleaseScene(scene); }

  std::vector<std::uint32_t> bricks_along(const RTCRay& ray) const {
    std::vector<std::uint32_t> bricks;
    CollectingContext context;
    context.bricks = &bricks;
    RTCRayHit rayhit = make_ray_hit(ray);
    intersect1(scene, rayhit, context.base);
    if (!context.bricks) throw std::bad_alloc();
    return bricks;
  }
};

SurfaceQuery::SurfaceQuery(const HypertextureGeometry& geometry, RTCDevice device)
    : impl_(std::make_unique<Impl>(geometry, device)) {}
SurfaceQuery::~SurfaceQuery() = default;

std::vector<SurfaceQuery::Hit> SurfaceQuery::all_hits(const Imath::V3f& origin,
                                                      const Imath::V3f& direction, float tnear,
                                                      float tfar) const {
  const Imath::V3d o(origin), d(direction);
  std::vector<Hit> found;
  for (const std::uint32_t brick : impl_->bricks_along(ray_of(origin, direction, tnear, tfar))) {
    auto from = static_cast<double>(tnear);
    while (const auto hit = impl_->geometry.intersect_brick(brick, o, d, from, tfar)) {
      found.push_back({hit->t, brick, hit->gradient.dot(d) > 0.0, hit->gradient});
      from = hit->beyond;
    }
  }
  std::sort(found.begin(), found.end(),
            [](const Hit& a, const Hit& b) { return a.t != b.t ? a.t < b.t : a.brick < b.brick; });

  // A root within the slack of two bricks is found by both, to within the tolerance of each. Two
  // roots of one brick are never the same.
  const double same = 4.0 * impl_->geometry.tolerance() / d.length();
  std::vector<Hit> hits;
  for (const Hit& hit : found) {
    bool known = false;
    for (auto before = hits.rbegin(); before != hits.rend() && hit.t - before->t <= same; ++before)
      known = known || (before->entering == hit.entering && before->brick != hit.brick);
    if (!known) hits.push_back(hit);
  }
  return hits;
}

std::optional<SurfaceQuery::Hit> SurfaceQuery::first_hit(const Imath::V3f& origin,
                                                         const Imath::V3f& direction, float tnear,
                                                         float tfar) const {
  const Imath::V3d o(origin), d(direction);
  std::optional<Hit> first;
  double end = tfar;
  for (const std::uint32_t brick : impl_->bricks_along(ray_of(origin, direction, tnear, tfar)))
    if (const auto hit = impl_->geometry.intersect_brick(brick, o, d, tnear, end)) {
      first = Hit{hit->t, brick, hit->gradient.dot(d) > 0.0, hit->gradient};
      end = hit->t;
    }
  return first;
}

bool SurfaceQuery::any_hit(const Imath::V3f& origin, const Imath::V3f& direction, float tnear,
                           float tfar) const {
  RTCRay ray = ray_of(origin, direction, tnear, tfar);
  return occluded1(impl_->scene, ray);
}

}  // namespace morsel::geom

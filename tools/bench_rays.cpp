// SPDX-License-Identifier: Apache-2.0
#include "tools/bench_rays.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <random>

#include "hypertexture_geom/embree/brick_surface.h"
#include "renderer/accel/scene_accel.h"

namespace morsel::tools {
namespace {

RTCRay ray_of(const BenchRay& r) {
  return geom::make_ray(r.origin.x, r.origin.y, r.origin.z, r.direction.x, r.direction.y,
                        r.direction.z);
}

// Whether it hits; `t` is where.
bool trace_one(RTCScene scene, const RaySet& set, const BenchRay& ray, float& t) {
  if (set.shadow) {
    RTCRay query = ray_of(ray);
    const bool hit = geom::occluded1(scene, query);
    t = hit ? 0.0f : std::numeric_limits<float>::infinity();
    return hit;
  }
  RTCRayHit query = geom::make_ray_hit(ray_of(ray));
  geom::intersect1(scene, query,
                   set.coherent ? geom::Coherence::kCoherent : geom::Coherence::kIncoherent);
  t = query.ray.tfar;
  return query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

RayCost operator+(RayCost a, const RayCost& b) {
  a.rays += b.rays;
  a.hits += b.hits;
  a.bricks += b.bricks;
  a.evaluations += b.evaluations;
  return a;
}

}  // namespace

double processor_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

RayCost trace(RTCScene scene, const RaySet& set, std::vector<float>* t) {
  constexpr std::size_t kGrain = 4096;
  if (t != nullptr) t->resize(set.rays.size());
  const double start = processor_seconds();
  RayCost cost = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, set.rays.size(), kGrain), RayCost{},
      [&](const tbb::blocked_range<std::size_t>& range, RayCost c) {
        const render::FlushDenormals flush;
        const geom::RayStatistics before = geom::ray_statistics();
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          float at = 0.0f;
          if (trace_one(scene, set, set.rays[i], at)) ++c.hits;
          if (t != nullptr) (*t)[i] = at;
        }
        c.rays += range.size();
        c.bricks += geom::ray_statistics().bricks - before.bricks;
        c.evaluations += geom::ray_statistics().evaluations - before.evaluations;
        return c;
      },
      [](const RayCost& a, const RayCost& b) { return a + b; });
  cost.seconds = processor_seconds() - start;
  return cost;
}

RaySet primary_rays(const topology::Box& bounds, int side) {
  constexpr int kTile = 32;
  constexpr float kField = 0.45f;  // width of the image plane at distance 1
  const Imath::V3f centre(topology::centre(bounds));
  const auto size = static_cast<float>((bounds.max - bounds.min).length());
  const Imath::V3f eye = centre + Imath::V3f(0.3f, 0.4f, 1.0f).normalized() * (1.6f * size);
  const Imath::V3f forward = (centre - eye).normalized();
  const Imath::V3f right = forward.cross(Imath::V3f(0, 1, 0)).normalized();
  const Imath::V3f up = right.cross(forward);
  RaySet set{"primary", {}, true, false};
  for (int y0 = 0; y0 < side; y0 += kTile)
    for (int x0 = 0; x0 < side; x0 += kTile)
      for (int y = y0; y < std::min(side, y0 + kTile); ++y)
        for (int x = x0; x < std::min(side, x0 + kTile); ++x) {
          const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(side) - 0.5f;
          const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(side) - 0.5f;
          set.rays.push_back(
              {eye, (forward + right * (kField * u) + up * (kField * v)).normalized()});
        }
  return set;
}

RaySet secondary_rays(const geom::HypertextureGeometry& geometry, RTCScene scene,
                      const RaySet& primary, double offset, bool shadow) {
  RaySet set{shadow ? "shadow" : "incoherent", {}, false, shadow};
  std::mt19937 random(shadow ? 2 : 1);
  std::normal_distribution<float> normal;
  for (const BenchRay& r : primary.rays) {
    RTCRayHit query = geom::make_ray_hit(ray_of(r));
    geom::intersect1(scene, query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
    const geom::ShadingPoint p =
        geometry.shade(query.hit.primID, r.origin + r.direction * query.ray.tfar);
    const Imath::V3f w(normal(random), normal(random), normal(random));
    set.rays.push_back({p.spawn_front + p.normal * static_cast<float>(offset),
                        (w.normalized() + p.normal).normalized()});
  }
  std::shuffle(set.rays.begin(), set.rays.end(), random);
  return set;
}

}  // namespace morsel::tools

// SPDX-License-Identifier: Apache-2.0
#include "renderer/accel/ray_log.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include "renderer/accel/scene_accel.h"

namespace morsel::render {

std::atomic<RayLog*> RayLog::active_{nullptr};

RayLog::RayLog() { active_.store(this); }

RayLog::~RayLog() {
  stop();
  if (RTCScene scene = scene_.load()) rtcReleaseScene(scene);
}

void RayLog::stop() {
  RayLog* self = this;
  active_.compare_exchange_strong(self, nullptr);
}

void RayLog::add(RTCScene scene, const RTCRay& ray, Query query) {
  if (scene_.load(std::memory_order_relaxed) == nullptr) {
    RTCScene none = nullptr;
    rtcRetainScene(scene);
    if (!scene_.compare_exchange_strong(none, scene)) rtcReleaseScene(scene);
  }
  records_.local().push_back({ray, query});
}

std::uint64_t RayLog::size() const {
  std::uint64_t count = 0;
  for (const auto& records : records_) count += records.size();
  return count;
}

std::uint64_t RayLog::replay() const {
  RTCScene const scene = scene_.load();
  std::atomic<std::uint64_t> hits{0};
  constexpr std::size_t kGrain = 4096;
  for (const std::vector<Record>& records : records_) {
    oneapi::tbb::parallel_for(
        oneapi::tbb::blocked_range<std::size_t>(0, records.size(), kGrain), [&](const auto& range) {
          const FlushDenormals flush;
          std::uint64_t found = 0;
          for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const Record& r = records[i];
            if (r.query == Query::kOccluded) {
              RTCRay ray = r.ray;
              found += geom::occluded1(scene, ray) ? 1u : 0u;
            } else {
              RTCRayHit ray = geom::make_ray_hit(r.ray);
              geom::intersect1(scene, ray,
                               r.query == Query::kCoherent ? geom::Coherence::kCoherent
                                                           : geom::Coherence::kIncoherent);
              found += ray.hit.geomID != RTC_INVALID_GEOMETRY_ID ? 1u : 0u;
            }
          }
          hits += found;
        });
  }
  return hits;
}

}  // namespace morsel::render

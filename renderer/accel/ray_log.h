// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <oneapi/tbb/enumerable_thread_specific.h>

#include <atomic>
#include <cstdint>
#include <vector>

#include "renderer/accel/embree_handles.h"

namespace morsel::render {

// While it lives, SceneAccel writes down the rays that it is asked about, so that what a render
// spends on rays can be measured by asking Embree again and nothing else. One at a time, and one
// scene at a time. Costs one load a ray when there is none.
class RayLog {
 public:
  enum class Query : std::uint8_t { kCoherent, kIncoherent, kOccluded };
  struct Record {
    RTCRay ray;
    Query query;
  };

  RayLog();
  ~RayLog();
  RayLog(const RayLog&) = delete;
  RayLog& operator=(const RayLog&) = delete;

  static RayLog* active() { return active_.load(std::memory_order_relaxed); }
  void add(RTCScene scene, const RTCRay& ray, Query query);

  // To be called when rendering has ended: no more is recorded. Asks again for every ray, in the
  // caller's TBB arena. Needs what the scene's geometries refer to, but no SceneAccel.
  void stop();
  std::uint64_t size() const;
  // Of the calling thread.
  const std::vector<Record>& own_records() { return records_.local(); }
  // How many rays hit something. The scene must have been asked of something.
  std::uint64_t replay() const;

 private:
  static std::atomic<RayLog*> active_;
  std::atomic<RTCScene> scene_{nullptr};  // retained
  oneapi::tbb::enumerable_thread_specific<std::vector<Record>> records_;
};

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/ray_surface.h"

namespace morsel::geom {

RayStatistics& ray_statistics() {
  thread_local RayStatistics statistics;
  return statistics;
}

bool RaySurface::first_kept(std::uint32_t primitive, RaySegment ray, Root& root) const {
  while (!filter_->keeps(ray.origin + ray.direction * root.t)) {
    ray.tnear = root.beyond;
    if (!(ray.tnear < ray.tfar) || !search(primitive, ray, false, root)) return false;
  }
  return true;
}

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/ray_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace morsel::geom {

RayStatistics& ray_statistics() {
  thread_local RayStatistics statistics;
  return statistics;
}

bool RaySurface::root_behind(std::uint32_t primitive, RaySegment ray, Root& root) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  while (!(root.t > ray.tnear)) {
    ray.tnear = std::max(root.beyond, std::nextafter(ray.tnear, kInfinity));
    if (!(ray.tnear < ray.tfar) || !search(primitive, ray, false, root)) return false;
  }
  return root.t < ray.tfar;
}

bool RaySurface::first_kept(std::uint32_t primitive, RaySegment ray, Root& root) const {
  for (;;) {
    ++ray_statistics().filtered;
    if (filter_->keeps(ray.origin + ray.direction * root.t)) return true;
    ray.tnear = root.beyond;
    if (!(ray.tnear < ray.tfar) || !next_root(primitive, ray, root)) return false;
  }
}

}  // namespace morsel::geom

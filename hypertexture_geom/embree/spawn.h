// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace morsel::geom {

struct SpawnPoint {
  Imath::V3f point;
  bool verified;  // the sign asked for was reached
};

// A float point near `x`, off it along `away` (unit), where `value` has the sign of `wanted`. The
// offset starts at `offset` and doubles; past `kTries` (a sheet thinner than the offset) the point
// where `value` came nearest to the sign is returned.
template <class Value>
SpawnPoint spawn_point(const Imath::V3d& x, const Imath::V3d& away, double offset, double wanted,
                       const Value& value) {
  constexpr int kTries = 14;
  Imath::V3f best(x);
  double best_value = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < kTries; ++i, offset *= 2.0) {
    const Imath::V3f p(x + away * offset);
    const double g = wanted * value(Imath::V3d(p));
    if (g > 0.0) return {p, true};
    if (g > best_value) best = p, best_value = g;
  }
  return {best, false};
}

// The rounding of x's coordinates to float moves it by no more than this (with room for the
// rounding of origin + t * direction that made x).
inline double float_error(const Imath::V3d& x) {
  const double largest = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  return 4.0 * std::numeric_limits<float>::epsilon() * largest;
}

}  // namespace morsel::geom

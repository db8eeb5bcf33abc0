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

// A float point near `x`, off it along `away` (unit), where `value` has the sign of `wanted`: a
// point at `offset`, which passes the surface for certain, but for a solid or a gap thinner than
// that; then nearer ones, for those. If neither has the sign, x is off the surface by more than
// `offset` says: the offset doubles as long as `single(p)` proves that no more than one surface
// lies between x and p, so that no point is ever behind another solid or gap. Where all fails the
// point is returned at which `value` came nearest to the sign.
template <class Value, class Single>
SpawnPoint spawn_point(const Imath::V3d& x, const Imath::V3d& away, double offset, double wanted,
                       const Value& value, const Single& single) {
  SpawnPoint best{Imath::V3f(x), false};
  double best_value = -std::numeric_limits<double>::infinity();
  const auto has_sign = [&](double distance) {
    const Imath::V3f p(x + away * distance);
    const double g = wanted * value(Imath::V3d(p));
    if (g > best_value) best = {p, g > 0.0}, best_value = g;
    return g > 0.0;
  };
  for (const double share : {1.0, 0.5, 0.25})
    if (has_sign(share * offset)) return best;
  constexpr int kDoublings = 13;
  for (int i = 0; i < kDoublings; ++i) {
    offset *= 2.0;
    if (!single(Imath::V3d(Imath::V3f(x + away * offset))) || has_sign(offset)) break;
  }
  return best;
}

// The rounding of x's coordinates to float moves it by no more than this (with room for the
// rounding of origin + t * direction that made x).
inline double float_error(const Imath::V3d& x) {
  const double largest = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  return 4.0 * std::numeric_limits<float>::epsilon() * largest;
}

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>

#include "hypertexture_geom/embree/segment.h"
#include "topology/local_model.h"

namespace morsel::geom {

// A cubic polynomial p on [0, 1] by its Bernstein coefficients: p lies between the least and the
// greatest of them, p(0) and p(1) are the outer two.
struct RayCubic {
  float b[4];

  float least() const { return std::min(std::min(b[0], b[1]), std::min(b[2], b[3])); }
  float greatest() const { return std::max(std::max(b[0], b[1]), std::max(b[2], b[3])); }
  float value(float s) const {
    const float r = 1.0f - s;
    return r * r * (r * b[0] + 3.0f * s * b[1]) + s * s * (3.0f * r * b[2] + s * b[3]);
  }
  float slope(float s) const {
    const float r = 1.0f - s;
    return 3.0f * (r * r * (b[1] - b[0]) + 2.0f * r * s * (b[2] - b[1]) + s * s * (b[3] - b[2]));
  }
  // Range of p' on [0, 1].
  void slopes(float& lo, float& hi) const {
    const float d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2];
    lo = 3.0f * std::min(std::min(d0, d1), d2);
    hi = 3.0f * std::max(std::max(d0, d1), d2);
  }
  // p'' at 0 and at 1; it is linear between.
  float first_curvature() const { return 6.0f * (b[0] - 2.0f * b[1] + b[2]); }
  float last_curvature() const { return 6.0f * (b[1] - 2.0f * b[2] + b[3]); }
  // Range of p'' on [0, 1].
  void curvatures(float& lo, float& hi) const {
    lo = std::min(first_curvature(), last_curvature());
    hi = std::max(first_curvature(), last_curvature());
  }
  // The same polynomial on the two halves of [0, 1] (de Casteljau).
  void split(RayCubic& left, RayCubic& right) const {
    const float p = 0.5f * (b[0] + b[1]), q = 0.5f * (b[1] + b[2]), r = 0.5f * (b[2] + b[3]);
    const float pq = 0.5f * (p + q), qr = 0.5f * (q + r), middle = 0.5f * (pq + qr);
    left = {{b[0], p, pq, middle}};
    right = {{middle, qr, r, b[3]}};
  }
};

// Rounding of `restrict_to_ray` and of RayCubic's own arithmetic, as a multiple of the sum of the
// polynomial's absolute coefficients, for points with |u_i| <= 1.01: each of the four values goes
// through at most 24 roundings, their interpolation multiplies that by 34 / 6 and adds as much for
// its own six.
inline constexpr float kRayCubicRounding = 200.0f * 0x1p-24f;

// Rounding of slopes and of curvatures, as multiples of that of values, on all parts of up to five
// halvings. `split` adds at most three roundings of the greatest coefficient a level, which the
// value's 200 cover (170 + 15). At level l, in units of the whole, they weigh 2^(l+1) and 4^(l+1)
// times as much: (170 + 186) * 6 of 200 for slopes, (170 + 4092) * 24 of 200 for curvatures, all
// coefficients up to 1.03 times the sum.
inline constexpr float kSlopeRounding = 12.0f, kCurvatureRounding = 600.0f;

// The cubic `c` (coefficients in the order of topology::monomial, in coordinates of the brick,
// where it spans [-1, 1]) along start + s * step, 0 <= s <= 1. Evaluates it at s = 0, 1/3, 2/3, 1
// side by side and interpolates.
inline RayCubic restrict_to_ray(const float* c, const float start[3], const float step[3]) {
  using namespace topology::monomial;
  // GCC's and Clang's vectors: four lanes on every machine, also without Highway's minimum (SSSE3).
  using Four = float __attribute__((vector_size(16)));
  constexpr Four kPlaces{0.0f, 1.0f / 3.0f, 2.0f / 3.0f, 1.0f};
  const Four x = kPlaces * step[0] + start[0];
  const Four y = kPlaces * step[1] + start[1];
  const Four z = kPlaces * step[2] + start[2];
  const Four p =
      c[k1] +
      x * (c[kX] + x * (c[kXX] + x * c[kXXX] + y * c[kXXY] + z * c[kXXZ]) +
           y * (c[kXY] + y * c[kXYY] + z * c[kXYZ]) + z * (c[kXZ] + z * c[kXZZ])) +
      y * (c[kY] + y * (c[kYY] + y * c[kYYY] + z * c[kYYZ]) + z * (c[kYZ] + z * c[kYZZ])) +
      z * (c[kZ] + z * (c[kZZ] + z * c[kZZZ]));
  const float v[4] = {p[0], p[1], p[2], p[3]};
  constexpr float kSixth = 1.0f / 6.0f;
  return {{v[0], kSixth * (-5.0f * v[0] + 18.0f * v[1] - 9.0f * v[2] + 2.0f * v[3]),
           kSixth * (2.0f * v[0] - 9.0f * v[1] + 18.0f * v[2] - 5.0f * v[3]), v[3]}};
}

// By how much the gradient of the cubic changes from start + from * step to start + to * step, with
// the rounding of two gradients in float: both are evaluated side by side.
inline Imath::V3d cubic_gradient_change(const float* c, const float start[3], const float step[3],
                                        float from, float to) {
  using namespace topology::monomial;
  using Four = float __attribute__((vector_size(16)));
  const Four places{from, to, from, to};
  const Four x = places * step[0] + start[0];
  const Four y = places * step[1] + start[1];
  const Four z = places * step[2] + start[2];
  const Four gx = x * (2.0f * c[kXX] + 3.0f * c[kXXX] * x + 2.0f * (c[kXXY] * y + c[kXXZ] * z)) +
                  y * (c[kXY] + c[kXYY] * y + c[kXYZ] * z) + z * (c[kXZ] + c[kXZZ] * z);
  const Four gy = y * (2.0f * c[kYY] + 3.0f * c[kYYY] * y + 2.0f * (c[kXYY] * x + c[kYYZ] * z)) +
                  x * (c[kXY] + c[kXXY] * x + c[kXYZ] * z) + z * (c[kYZ] + c[kYZZ] * z);
  const Four gz = z * (2.0f * c[kZZ] + 3.0f * c[kZZZ] * z + 2.0f * (c[kXZZ] * x + c[kYZZ] * y)) +
                  x * (c[kXZ] + c[kXXZ] * x + c[kXYZ] * y) + y * (c[kYZ] + c[kYYZ] * y);
  return {static_cast<double>(gx[1] - gx[0]), static_cast<double>(gy[1] - gy[0]),
          static_cast<double>(gz[1] - gz[0])};
}

// How far g(s) = F(entry + s * (exit - entry)) and its derivatives may differ from the cubic's on
// [0, 1].
struct RayCubicError {
  float value, slope, curvature;
};

}  // namespace morsel::geom

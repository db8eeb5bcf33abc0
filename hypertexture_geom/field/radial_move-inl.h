// SPDX-License-Identifier: Apache-2.0
// A radial polynomial about another centre, for one centre or one a lane.
#if defined(MORSEL_FIELD_RADIAL_MOVE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MORSEL_FIELD_RADIAL_MOVE_INL_H_
#undef MORSEL_FIELD_RADIAL_MOVE_INL_H_
#else
#define MORSEL_FIELD_RADIAL_MOVE_INL_H_
#endif

#include <hwy/highway.h>

#include <limits>

#include "hypertexture_geom/field/radial_polynomial.h"

HWY_BEFORE_NAMESPACE();
namespace morsel::geom::HWY_NAMESPACE {

// Bounds what move_radial() adds to a RadialPolynomial's error, in parts of its size. In every
// coefficient that it computes, all terms would be added if all numbers were positive, and none
// goes through more than 40 roundings (with one in each component of `d`, of which there are at
// most six). So with A the polynomial with absolute coefficients, the new one is off by at most 40
// units of A(|d| + |u|), and |d| + |u| is within the box: the same for derivatives.
inline constexpr double kMoved = 64.0 * std::numeric_limits<double>::epsilon();

template <class T>
struct RadialCoefficients {
  T c[topology::monomial::kCount], form[6], quintic[3], sextic;
};

template <class T>
HWY_INLINE RadialCoefficients<T> coefficients_of(const RadialPolynomial& p) {
  RadialCoefficients<T> r;
  for (int i = 0; i < topology::monomial::kCount; ++i) r.c[i] = T(p.c[i]);
  for (int i = 0; i < 6; ++i) r.form[i] = T(p.form[i]);
  for (int i = 0; i < 3; ++i) r.quintic[i] = T(p.quintic[i]);
  r.sextic = T(p.sextic);
  return r;
}

// Replaces u by d + u. With r = |u|^2, m = 2 d, D = |d|^2 and l = m.u, |d + u|^2 = r + l + D, so
// that
//   w |d + u|^6                      = w (r + l + D)^3
//   (v.(d + u)) |d + u|^4            = (v.u + a) (r + l + D)^2,               a = v.d
//   |d + u|^2 (d + u).T (d + u)      = (u.T u + b.u + t) (r + l + D),   b = T m, t = d.T d
template <class T>
HWY_INLINE void move_radial(RadialCoefficients<T>& p, const T (&d)[3]) {
  using namespace topology::monomial;
  const T two(2.0), three(3.0), half(0.5);
  auto& c = p.c;
  auto& f = p.form;
  auto& v = p.quintic;
  // The cubic by itself: a derivative's increments are exact by the mean of the next one's ends.
  const T old[6] = {c[kXX], c[kYY], c[kZZ], c[kXY], c[kXZ], c[kYZ]};
  const T d3[3] = {three * d[0], three * d[1], three * d[2]};
  const T m[3] = {d[0] + d[0], d[1] + d[1], d[2] + d[2]};
  c[kXX] += c[kXXX] * d3[0] + c[kXXY] * d[1] + c[kXXZ] * d[2];
  c[kYY] += c[kXYY] * d[0] + c[kYYY] * d3[1] + c[kYYZ] * d[2];
  c[kZZ] += c[kXZZ] * d[0] + c[kYZZ] * d[1] + c[kZZZ] * d3[2];
  c[kXY] += c[kXXY] * m[0] + c[kXYY] * m[1] + c[kXYZ] * d[2];
  c[kXZ] += c[kXXZ] * m[0] + c[kXYZ] * d[1] + c[kXZZ] * m[2];
  c[kYZ] += c[kXYZ] * d[0] + c[kYYZ] * m[1] + c[kYZZ] * m[2];
  T mean[6], third[6];  // (old + new) / 2 and (2 old + new) / 3
  for (int i = 0; i < 6; ++i) {
    const T both = old[i] + c[kXX + i];
    mean[i] = i < 3 ? both : half * both;
    third[i] = (both + old[i]) * T(1.0 / 3.0);
  }
  c[k1] += d[0] * (c[kX] + third[0] * d[0] + third[3] * d[1] + third[4] * d[2]) +
           d[1] * (c[kY] + third[1] * d[1] + third[5] * d[2]) + d[2] * (c[kZ] + third[2] * d[2]);
  c[kX] += mean[0] * d[0] + mean[3] * d[1] + mean[4] * d[2];
  c[kY] += mean[3] * d[0] + mean[1] * d[1] + mean[5] * d[2];
  c[kZ] += mean[4] * d[0] + mean[5] * d[1] + mean[2] * d[2];

  // What the higher terms leave in the cubic.
  const T w = p.sextic, square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  const T a = v[0] * d[0] + v[1] * d[1] + v[2] * d[2];
  const T b[3] = {f[0] * m[0] + f[3] * m[1] + f[4] * m[2], f[3] * m[0] + f[1] * m[1] + f[5] * m[2],
                  f[4] * m[0] + f[5] * m[1] + f[2] * m[2]};
  const T t = half * (b[0] * d[0] + b[1] * d[1] + b[2] * d[2]);
  const T steep = three * w * square + a, bend = t + square * (steep + a);
  T linear[3], slope[3], wm[3], q[3];
  for (int i = 0; i < 3; ++i) {
    const T dv = square * v[i];
    linear[i] = steep * m[i] + two * dv + b[i];
    slope[i] = linear[i] + steep * m[i];
    wm[i] = w * m[i];
    q[i] = v[i] + wm[i];
    c[kX + i] += bend * m[i] + square * (dv + b[i]);
    c[kXX + i] += bend + square * f[i] + m[i] * linear[i];
  }
  c[k1] += square * (t + square * (a + square * w));
  const T square2 = square + square;
  c[kXY] += square2 * f[3] + m[0] * linear[1] + m[1] * linear[0];
  c[kXZ] += square2 * f[4] + m[0] * linear[2] + m[2] * linear[0];
  c[kYZ] += square2 * f[5] + m[1] * linear[2] + m[2] * linear[1];
  // r (slope.u) + l u.Q u, Q = T + (m q^T + q m^T) / 2.
  const T Q[3] = {f[0] + m[0] * q[0], f[1] + m[1] * q[1], f[2] + m[2] * q[2]};
  const T xy = two * f[3] + m[0] * q[1] + m[1] * q[0], xz = two * f[4] + m[0] * q[2] + m[2] * q[0],
          yz = two * f[5] + m[1] * q[2] + m[2] * q[1];
  c[kXXX] += slope[0] + m[0] * Q[0];
  c[kYYY] += slope[1] + m[1] * Q[1];
  c[kZZZ] += slope[2] + m[2] * Q[2];
  c[kXXY] += slope[1] + m[1] * Q[0] + m[0] * xy;
  c[kXXZ] += slope[2] + m[2] * Q[0] + m[0] * xz;
  c[kXYY] += slope[0] + m[0] * Q[1] + m[1] * xy;
  c[kYYZ] += slope[2] + m[2] * Q[1] + m[1] * yz;
  c[kXZZ] += slope[0] + m[0] * Q[2] + m[2] * xz;
  c[kYZZ] += slope[1] + m[1] * Q[2] + m[2] * yz;
  c[kXYZ] += m[0] * yz + m[1] * xz + m[2] * xy;

  // T and v.
  const T e[3] = {q[0] + half * wm[0], q[1] + half * wm[1], q[2] + half * wm[2]};
  for (int i = 0; i < 3; ++i) {
    f[i] += steep + m[i] * (e[i] + e[i]);
    v[i] += three * wm[i];
  }
  f[3] += m[0] * e[1] + m[1] * e[0];
  f[4] += m[0] * e[2] + m[2] * e[0];
  f[5] += m[1] * e[2] + m[2] * e[1];
}

}  // namespace morsel::geom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

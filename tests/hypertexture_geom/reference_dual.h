// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "tests/hypertexture_geom/reference_field.h"

// Arithmetic of dual numbers in long double, and what the parts of the reference share.
namespace morsel::geom::testing {

using Point = Dual[3];
using Places = std::vector<std::array<double, 3>>;
using Reference = std::shared_ptr<const ReferenceField>;
using Real = long double;

inline Dual operator+(Dual a, const Dual& b) {
  a.v += b.v;
  for (int i = 0; i < 3; ++i) a.g[i] += b.g[i];
  return a;
}
inline Dual operator*(Real s, Dual a) {
  a.v *= s;
  for (Real& g : a.g) g *= s;
  return a;
}
inline Dual operator-(const Dual& a, const Dual& b) { return a + -1.0L * b; }
inline Dual operator+(Dual a, Real c) {
  a.v += c;
  return a;
}
inline Dual chain(Real value, Real slope, Dual a) {
  a.v = value;
  for (Real& g : a.g) g *= slope;
  return a;
}
inline Dual operator*(const Dual& a, const Dual& b) {
  Dual r;
  r.v = a.v * b.v;
  for (int i = 0; i < 3; ++i) r.g[i] = a.v * b.g[i] + b.v * a.g[i];
  return r;
}
inline Dual root(const Dual& a) {
  const Real r = std::sqrt(a.v);
  return chain(r, 0.5L / r, a);
}
inline Dual smooth_absolute(const Dual& a, Real k) {
  const Real r = std::sqrt(a.v * a.v + k * k);
  return chain(a.v * (a.v / (r + k)), a.v / r, a);
}
inline Dual squared(const Dual& a) { return a * a; }

// A density from its canonical JSON.
Reference reference_density(const nlohmann::json& description);

}  // namespace morsel::geom::testing

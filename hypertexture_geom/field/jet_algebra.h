// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "topology/scalar_field.h"

// Arithmetic of values with first and second derivatives in space (forward-mode differentiation).
namespace morsel::geom::jets {

using topology::Jet;

// Pairs of axes in the order of Jet::hessian.
inline constexpr int kPair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

inline Jet constant(double value) {
  Jet jet;
  jet.value = value;
  return jet;
}

inline Jet operator+(Jet a, const Jet& b) {
  a.value += b.value;
  a.gradient += b.gradient;
  for (int k = 0; k < 6; ++k) a.hessian[k] += b.hessian[k];
  return a;
}

inline Jet operator*(double factor, Jet a) {
  a.value *= factor;
  a.gradient *= factor;
  for (double& h : a.hessian) h *= factor;
  return a;
}

inline Jet operator*(const Jet& a, double factor) { return factor * a; }
inline Jet operator-(const Jet& a) { return -1.0 * a; }
inline Jet operator-(const Jet& a, const Jet& b) { return a + -b; }

inline Jet operator+(Jet a, double b) {
  a.value += b;
  return a;
}
inline Jet operator+(double a, const Jet& b) { return b + a; }
inline Jet operator-(const Jet& a, double b) { return a + -b; }
inline Jet operator-(double a, const Jet& b) { return -b + a; }

inline Jet operator*(const Jet& a, const Jet& b) {
  Jet r;
  r.value = a.value * b.value;
  r.gradient = a.value * b.gradient + b.value * a.gradient;
  for (int k = 0; k < 6; ++k) {
    const int i = kPair[k][0], j = kPair[k][1];
    r.hessian[k] = a.value * b.hessian[k] + b.value * a.hessian[k] + a.gradient[i] * b.gradient[j] +
                   a.gradient[j] * b.gradient[i];
  }
  return r;
}

// f(a) from f and its first two derivatives at a.value.
inline Jet compose(double f, double slope, double bend, const Jet& a) {
  Jet r;
  r.value = f;
  r.gradient = slope * a.gradient;
  for (int k = 0; k < 6; ++k)
    r.hessian[k] = slope * a.hessian[k] + bend * a.gradient[kPair[k][0]] * a.gradient[kPair[k][1]];
  return r;
}

}  // namespace morsel::geom::jets

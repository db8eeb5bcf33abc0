// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "hypertexture_geom/field/tensor_model.h"

namespace morsel::geom {

// Bounds on one octave of improved Perlin noise with the 12 edge directions, amplitude 1 and
// frequency 1, over all of space and all choices of directions: on |n|, on |dn/dx_i|, on
// |d2n/dx_i dx_j| and on the (one-sided) third derivatives. Proved by subdivision of a cell in
// tests/hypertexture_geom/perlin_bounds_test.cpp; the suprema are about 1.0363, 3.75, 12.04 and
// 150.4.
inline constexpr double kPerlinBound[4] = {1.0364, 3.76, 12.2, 152.0};

// Sums octaves of Perlin noise into the cubic model of one box.
//
// With W(t) = 1 - fade(|t|) on [-1, 1], else 0, the noise is a sum over lattice points c of
// products
//   W(x - c_x) W(y - c_y) W(z - c_z) g_c . (p - c),
// and W is twice continuously differentiable: across a lattice plane only its third derivative
// jumps. On a box narrower than a cell, each of W(t) and W(t) t is then one polynomial of degree 5
// or 6 plus, if the box straddles a plane k of that axis, max(0, t - k)^3 times a quadratic or
// cubic. The truncated cube is replaced by one cubic polynomial with known errors
// (truncated_cube.h), so that every function of one variable is a polynomial of degree 6 and the
// noise a product of three. What the replacement costs is the product of the cube's error with a
// polynomial, the jump, which is computed and bounded like the noise itself: octaves, lattice
// points and directions cancel in it as they do in the noise. The polynomials of all octaves are
// added before any term is dropped.
class PerlinSum {
 public:
  // `finest` is the largest frequency of any octave that will be added.
  PerlinSum(const topology::Box& box, double finest);

  // Index into kPerlinDirection at a lattice point.
  using Directions = std::function<int(std::int64_t, std::int64_t, std::int64_t)>;

  // amplitude * n(frequency * x + offset).
  void add(double amplitude, double frequency, const Imath::V3d& offset,
           const Directions& directions);

  topology::LocalModel finish();

 private:
  void add_bounds(double amplitude, double frequency);

  topology::LocalModel model_;
  Imath::V3d scale_;  // the half size, but never 0: bounds for a slightly larger box hold too
  TensorPolynomial sum_;
  DerivativeBounds3 error_, rounding_;
};

}  // namespace morsel::geom

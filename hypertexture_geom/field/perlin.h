// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "hypertexture_geom/field/expression.h"
#include "hypertexture_geom/field/sparse_convolution.h"

namespace morsel::geom {

struct PerlinParameters {
  std::vector<Octave> octaves;
  std::uint32_t seed = 0;
  // Octave i draws its random numbers as octave number first_octave + i: noises of one seed are
  // independent where these numbers differ.
  std::uint32_t first_octave = 0;
};

// Sum of octaves of Perlin's improved gradient noise (K. Perlin, "Improving Noise", SIGGRAPH 2002):
// on each cell of the integer lattice the 8 corners' linear functions g_c . (p - c), g_c one of the
// 12 directions to the edges of a cube, are interpolated along each axis with the fade curve
//   fade(t) = 6 t^5 - 15 t^4 + 10 t^3.
// Twice continuously differentiable, 0 at every lattice point. Octave i is amplitude_i
// n(frequency_i x + o_i), with directions and the offset o_i hashed from i and the seed
// (perlin_lattice.h).
//
// The mean is 0 and the standard deviation 0.2700: with A = int (1-f)^2 + f^2 = 0.78355 and
// B = int ((1-f) t)^2 + (f (1-t))^2 = 0.059385 over [0, 1], f = fade(t), its square is 2 A^2 B
// (directions are uncorrelated, their covariance is 2/3 of the unit matrix). That is half of sparse
// convolution's: the same amplitude looks half as strong. |n| <= 1.04 everywhere.
std::unique_ptr<Expression> make_perlin(const PerlinParameters& parameters);

}  // namespace morsel::geom

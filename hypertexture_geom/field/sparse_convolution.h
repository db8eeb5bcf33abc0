// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "hypertexture_geom/field/expression.h"

namespace morsel::geom {

// An octave: amplitude * n(frequency * x).
struct Octave {
  double amplitude = 1.0;
  double frequency = 1.0;  // lattice cells per unit of length
};

// Octaves of a fractional Brownian motion: amplitude * lacunarity^(-hurst i), frequency *
// lacunarity^i (equation 13 of Gamito & Maddock).
std::vector<Octave> fbm_octaves(double amplitude, double frequency, int layers, double lacunarity,
                                double hurst);

struct SparseConvolutionParameters {
  std::vector<Octave> octaves;
  std::uint32_t seed = 0;
  int impulses_per_cell = 3;
  // Octave i draws its random numbers as octave number first_octave + i of the process: noises of
  // one seed are independent where these numbers differ.
  std::uint32_t first_octave = 0;
};

// Sum of octaves of sparse convolution noise (J.-P. Lewis, "Algorithms for solid noise synthesis",
// 1989):
//   n(p) = sqrt(3 / m) sum_k w_k K(|p - c_k|),  K(r) = (1 - r^2)^3 for r < 1, else 0 (twice
//   continuously differentiable)
// with m impulses uniformly distributed in every unit lattice cell, w_k uniform in [-1, 1). The
// mean is 0 and the standard deviation 0.5345 whatever m: m/3 (3/m) 4 pi int K^2 r^2 dr = 0.2857 is
// its square. Cells more than 2^51 from the origin have no impulses: doubles do not resolve them.
std::unique_ptr<Expression> make_sparse_convolution(const SparseConvolutionParameters& parameters);

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hypertexture_geom/field/expression.h"
#include "hypertexture_geom/field/sparse_convolution.h"
#include "hypertexture_geom/params/json_reader.h"

namespace morsel::geom {

// Octaves of a basis noise as modulations name them.
struct NoiseDescription {
  std::string basis = "sparse_convolution";
  std::vector<Octave> octaves;
  std::uint32_t seed = 0;
  int impulses_per_cell = 3;  // sparse convolution only
};

// The parameters that choose a basis noise and its octaves, for a modulation's declaration.
// `amplitude_help` says what the amplitude is of.
std::vector<params::Parameter> noise_parameters(const std::string& amplitude_help);

// Reads them. Throws params::InputError when octaves are too fine.
NoiseDescription noise_from_json(const params::JsonReader& reader);

// The sum of `count` octaves from `first` on. Each octave and each `stream` (below 2^16) has random
// numbers of its own: stream 0 is what fbm uses.
std::unique_ptr<Expression> make_noise(const NoiseDescription& noise, std::size_t first,
                                       std::size_t count, std::uint32_t stream = 0);

// All octaves.
std::unique_ptr<Expression> make_noise(const NoiseDescription& noise);

}  // namespace morsel::geom

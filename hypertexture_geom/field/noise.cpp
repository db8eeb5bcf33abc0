// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/noise.h"

#include "hypertexture_geom/field/perlin.h"

namespace morsel::geom {

using params::Type;

std::vector<params::Parameter> noise_parameters(const std::string& amplitude_help) {
  return {
      {.name = "noise",
       .type = Type::kChoice,
       .default_value = "sparse_convolution",
       .help =
           "Basis noise: sparse convolution (standard deviation 0.53 for amplitude 1) or Perlin's "
           "improved gradient noise (0.27).",
       .choices = {"sparse_convolution", "perlin"}},
      {"amplitude", Type::kNumber, 0.1, amplitude_help, "length", -1e6, 1e6},
      {"frequency", Type::kNumber, 3.0, "Lattice cells per unit of length in the first octave.",
       "1/length", 1e-6, 1e6},
      {"layers", Type::kInteger, 1, "Number of octaves.", "", 1, 16},
      {"lacunarity", Type::kNumber, 2.0, "Ratio of the frequencies of successive octaves.", "", 1.0,
       8.0, true},
      {"hurst", Type::kNumber, 0.8, "Hurst exponent: larger is smoother.", "", 0.0, 4.0},
      {"seed", Type::kInteger, 0, "Seed of the noise's random numbers.", "", 0, 4294967295.0},
      {.name = "impulses_per_cell",
       .type = Type::kInteger,
       .default_value = 3,
       .help = "Impulses in each lattice cell; of sparse convolution alone, refused with other "
               "noises.",
       .min = 1,
       .max = 64,
       .only_with = "noise",
       .only_with_value = "sparse_convolution"}};
}

NoiseDescription noise_from_json(const params::JsonReader& r) {
  NoiseDescription noise;
  noise.basis = r.string("noise");
  noise.octaves =
      fbm_octaves(r.number("amplitude"), r.number("frequency"),
                  static_cast<int>(r.integer("layers")), r.number("lacunarity"), r.number("hurst"));
  noise.seed = static_cast<std::uint32_t>(r.integer("seed"));
  noise.impulses_per_cell = static_cast<int>(r.integer("impulses_per_cell"));
  if (noise.octaves.back().frequency > 1e9)
    r.place("layers").fail("the finest octave's frequency exceeds 1e9 cells per unit of length");
  return noise;
}

std::unique_ptr<Expression> make_noise(const NoiseDescription& noise, std::size_t first,
                                       std::size_t count, std::uint32_t stream) {
  const std::vector<Octave> octaves(
      noise.octaves.begin() + static_cast<std::ptrdiff_t>(first),
      noise.octaves.begin() + static_cast<std::ptrdiff_t>(first + count));
  const std::uint32_t first_octave = (stream << 16) + static_cast<std::uint32_t>(first);
  if (noise.basis == "perlin")
    return make_perlin({.octaves = octaves, .seed = noise.seed, .first_octave = first_octave});
  SparseConvolutionParameters p;
  p.octaves = octaves;
  p.first_octave = first_octave;
  p.seed = noise.seed;
  p.impulses_per_cell = noise.impulses_per_cell;
  return make_sparse_convolution(p);
}

std::unique_ptr<Expression> make_noise(const NoiseDescription& noise) {
  return make_noise(noise, 0, noise.octaves.size());
}

}  // namespace morsel::geom

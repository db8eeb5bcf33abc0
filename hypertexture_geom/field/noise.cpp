// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/noise.h"

namespace morsel::geom {

using params::Type;

std::vector<params::Parameter> noise_parameters(const std::string& amplitude_help) {
  return {{.name = "noise",
           .type = Type::kChoice,
           .default_value = "sparse_convolution",
           .help = "Basis noise.",
           .choices = {"sparse_convolution"}},
          {"amplitude", Type::kNumber, 0.1, amplitude_help, "length", -1e6, 1e6},
          {"frequency", Type::kNumber, 3.0, "Lattice cells per unit of length in the first octave.",
           "1/length", 1e-6, 1e6},
          {"layers", Type::kInteger, 1, "Number of octaves.", "", 1, 16},
          {"lacunarity", Type::kNumber, 2.0, "Ratio of the frequencies of successive octaves.", "",
           1.0, 8.0, true},
          {"hurst", Type::kNumber, 0.8, "Hurst exponent: larger is smoother.", "", 0.0, 4.0},
          {"seed", Type::kInteger, 0, "Seed of the noise's random numbers.", "", 0, 4294967295.0},
          {"impulses_per_cell", Type::kInteger, 3,
           "Impulses in each lattice cell (sparse convolution).", "", 1, 64}};
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
  SparseConvolutionParameters p;
  p.octaves.assign(noise.octaves.begin() + static_cast<std::ptrdiff_t>(first),
                   noise.octaves.begin() + static_cast<std::ptrdiff_t>(first + count));
  p.first_octave = (stream << 16) + static_cast<std::uint32_t>(first);
  p.seed = noise.seed;
  p.impulses_per_cell = noise.impulses_per_cell;
  return make_sparse_convolution(p);
}

std::unique_ptr<Expression> make_noise(const NoiseDescription& noise) {
  return make_noise(noise, 0, noise.octaves.size());
}

}  // namespace morsel::geom

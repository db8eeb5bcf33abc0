// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/turbulence.h"

#include "hypertexture_geom/field/mask.h"
#include "hypertexture_geom/field/noise.h"
#include "hypertexture_geom/field/sum.h"
#include "hypertexture_geom/field/univariate_function.h"

namespace morsel::geom {

using params::JsonReader;
using params::Type;

ModulationEntry turbulence_entry() {
  ModulationEntry entry;
  entry.declaration = {
      "turbulence",
      "Adds the smooth absolute values of octaves of noise, octave i scaled by lacunarity^(-hurst "
      "i) at frequency lacunarity^i.",
      {{"type", Type::kString, "turbulence", "Kind of modulation."},
       {"smoothing", Type::kNumber, 0.1,
        "Rounds the creases, in units of the noise: |t| is sqrt(t^2 + smoothing^2) - smoothing.",
        "", 1e-6, 1e3},
       mask_parameter()}};
  for (params::Parameter& p : noise_parameters("Factor of the first octave."))
    entry.declaration.parameters.push_back(std::move(p));
  entry.make = [](std::shared_ptr<const Expression> previous, const JsonReader& r) {
    NoiseDescription noise = noise_from_json(r);
    std::shared_ptr<const Expression> sum;
    for (std::size_t i = 0; i < noise.octaves.size(); ++i) {
      const double amplitude = noise.octaves[i].amplitude;
      noise.octaves[i].amplitude = 1.0;
      std::shared_ptr<const Expression> octave = make_univariate(
          hyperbola_function({.width = r.number("smoothing"), .absolute = amplitude}),
          make_noise(noise, i, 1));
      sum = sum ? make_sum(std::move(sum), std::move(octave)) : std::move(octave);
    }
    return make_sum(std::move(previous), masked(std::move(sum), r));
  };
  return entry;
}

}  // namespace morsel::geom

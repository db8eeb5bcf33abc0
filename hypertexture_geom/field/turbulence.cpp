// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/turbulence.h"

#include "hypertexture_geom/field/folded_noise.h"

namespace morsel::geom {

using params::JsonReader;

ModulationEntry turbulence_entry() {
  return {folded_noise_declaration(
              "turbulence",
              "Adds the smooth absolute values of octaves of noise, octave i scaled by "
              "lacunarity^(-hurst i) at frequency lacunarity^i.",
              "Rounds the creases, in units of the noise: |t| is sqrt(t^2 + smoothing^2) - "
              "smoothing.",
              {}),
          [](std::shared_ptr<const Expression> previous, const JsonReader& r) {
            return make_folded_noise(std::move(previous), r, [&](double amplitude) {
              return hyperbola_function({.width = r.number("smoothing"), .absolute = amplitude});
            });
          }};
}

}  // namespace morsel::geom

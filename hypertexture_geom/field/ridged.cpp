// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/ridged.h"

#include "hypertexture_geom/field/folded_noise.h"

namespace morsel::geom {

using params::JsonReader;
using params::Type;

ModulationEntry ridged_entry() {
  return {
      folded_noise_declaration(
          "ridged",
          "Adds octaves of (offset - |noise|) or its square, octave i scaled by "
          "lacunarity^(-hurst i) at frequency lacunarity^i: crests where the noise changes "
          "sign.",
          "Rounds the crests, in units of the noise: |t| is sqrt(t^2 + smoothing^2) - "
          "smoothing.",
          {{"offset", Type::kNumber, 1.0, "Height of the crests, in units of the noise.", "",
            -100.0, 100.0},
           {"squared", Type::kBoolean, true, "Whether to square what is left: sharper crests."}}),
      [](std::shared_ptr<const Expression> previous, const JsonReader& r) {
        return make_folded_noise(std::move(previous), r, [&](double amplitude) {
          const bool squared = r.boolean("squared");
          const double factor = squared ? 1.0 : amplitude;
          const Hyperbola ridge{.width = r.number("smoothing"),
                                .constant = factor * r.number("offset"),
                                .absolute = -factor};
          return squared ? squared_hyperbola_function(ridge, amplitude) : hyperbola_function(ridge);
        });
      }};
}

}  // namespace morsel::geom

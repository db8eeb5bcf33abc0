// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/fbm.h"

#include "hypertexture_geom/field/mask.h"
#include "hypertexture_geom/field/noise.h"
#include "hypertexture_geom/field/sum.h"

namespace morsel::geom {

ModulationEntry fbm_entry() {
  ModulationEntry entry;
  entry.declaration = {
      "fbm",
      "Adds octaves of noise, octave i scaled by lacunarity^(-hurst i) at "
      "frequency lacunarity^i (equation 13 of the paper).",
      {{"type", params::Type::kString, "fbm", "Kind of modulation."}, mask_parameter()}};
  for (params::Parameter& p : noise_parameters("Factor of the first octave."))
    entry.declaration.parameters.push_back(std::move(p));
  entry.make = [](std::shared_ptr<const Expression> previous, const params::JsonReader& r) {
    return make_sum(std::move(previous), masked(make_noise(noise_from_json(r)), r));
  };
  return entry;
}

}  // namespace morsel::geom

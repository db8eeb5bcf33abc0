// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/folded_noise.h"

#include <utility>

#include "hypertexture_geom/field/mask.h"
#include "hypertexture_geom/field/noise.h"
#include "hypertexture_geom/field/sum.h"

namespace morsel::geom {

using params::Type;

params::Declaration folded_noise_declaration(const std::string& name, const std::string& help,
                                             const std::string& smoothing_help,
                                             std::vector<params::Parameter> more) {
  params::Declaration declaration{
      name,
      help,
      {{"type", Type::kString, name, "Kind of modulation."},
       {"smoothing", Type::kNumber, 0.1, smoothing_help, "", 1e-6, 1e3}}};
  const auto append = [&](std::vector<params::Parameter> list) {
    for (params::Parameter& p : list) declaration.parameters.push_back(std::move(p));
  };
  append(std::move(more));
  append({mask_parameter()});
  append(noise_parameters("Factor of the first octave."));
  return declaration;
}

std::unique_ptr<Expression> make_folded_noise(
    std::shared_ptr<const Expression> previous, const params::JsonReader& reader,
    const std::function<std::shared_ptr<const UnivariateFunction>(double amplitude)>& fold) {
  NoiseDescription noise = noise_from_json(reader);
  std::shared_ptr<const Expression> sum;
  for (std::size_t i = 0; i < noise.octaves.size(); ++i) {
    const double amplitude = std::exchange(noise.octaves[i].amplitude, 1.0);
    std::shared_ptr<const Expression> octave =
        make_univariate(fold(amplitude), make_noise(noise, i, 1));
    sum = sum ? make_sum(std::move(sum), std::move(octave)) : std::move(octave);
  }
  return make_sum(std::move(previous), masked(std::move(sum), reader));
}

}  // namespace morsel::geom

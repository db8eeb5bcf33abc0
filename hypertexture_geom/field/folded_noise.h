// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "hypertexture_geom/field/registry.h"
#include "hypertexture_geom/field/univariate_function.h"

namespace morsel::geom {

// What turbulence and ridged noise have in common: octaves n(f_i x) of a noise, each put through a
// function of its value that depends on the octave's amplitude, summed and added to what came
// before.

// The parameters "smoothing" (with this help), those given, "mask" and those of the noise.
params::Declaration folded_noise_declaration(const std::string& name, const std::string& help,
                                             const std::string& smoothing_help,
                                             std::vector<params::Parameter> more);

// previous + mask sum_i fold(a_i)(n(f_i x)).
std::unique_ptr<Expression> make_folded_noise(
    std::shared_ptr<const Expression> previous, const params::JsonReader& reader,
    const std::function<std::shared_ptr<const UnivariateFunction>(double amplitude)>& fold);

}  // namespace morsel::geom

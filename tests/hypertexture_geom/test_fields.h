// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "hypertexture_geom/field/field.h"

namespace morsel::geom::testing {

// Equation (13) of the paper as scene JSON.
inline nlohmann::json eq13_json(int layers, int seed, double amplitude = 0.8,
                                double frequency = 3.0) {
  return {{"density", {{"type", "sphere"}, {"radius", 1.0}}},
          {"modulations",
           {{{"type", "fbm"},
             {"noise", "sparse_convolution"},
             {"amplitude", amplitude},
             {"frequency", frequency},
             {"layers", layers},
             {"seed", seed}}}}};
}

// The same with Perlin noise; equation (3) is one layer at frequency 4.
inline nlohmann::json perlin_json(int layers, int seed, double amplitude = 0.8,
                                  double frequency = 3.0) {
  nlohmann::json json = eq13_json(layers, seed, amplitude, frequency);
  json["modulations"][0]["noise"] = "perlin";
  return json;
}

inline std::shared_ptr<const Field> field_of(const nlohmann::json& json) {
  return field_from_json(json, params::Place{"test", ""});
}

}  // namespace morsel::geom::testing

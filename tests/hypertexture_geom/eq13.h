// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json.hpp>

#include "hypertexture_geom/embree/geometry.h"

namespace morsel::geom::test {

// Equation (13) of Gamito & Maddock with the given number of layers, amplitude 0.8.
inline Hypertexture eq13(int layers, int seed = 1) {
  const nlohmann::json json{{"name", "rock"},
                            {"type", "hypertexture"},
                            {"field",
                             {{"density", {{"type", "sphere"}, {"radius", 1}}},
                              {"modulations",
                               {{{"type", "fbm"},
                                 {"noise", "sparse_convolution"},
                                 {"amplitude", 0.8},
                                 {"frequency", 3},
                                 {"layers", layers},
                                 {"lacunarity", 2},
                                 {"hurst", 0.8},
                                 {"seed", seed},
                                 {"impulses_per_cell", 3}}}}}}};
  return hypertexture_from_json(json, {"eq13", ""});
}

}  // namespace morsel::geom::test

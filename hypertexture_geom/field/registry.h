// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hypertexture_geom/field/expression.h"
#include "hypertexture_geom/params/json_reader.h"

namespace morsel::geom {

// A density D: its declaration (the name is its "type" in a scene) and how it is made.
struct DensityEntry {
  params::Declaration declaration;
  std::function<std::unique_ptr<Expression>(const params::JsonReader&)> make;
};

// A modulation f_i: makes f_i(previous, x) from what came before it in the sequence.
struct ModulationEntry {
  params::Declaration declaration;
  std::function<std::unique_ptr<Expression>(std::shared_ptr<const Expression> previous,
                                            const params::JsonReader&)>
      make;
};

// All that a scene may name; one line each.
const std::vector<DensityEntry>& densities();
const std::vector<ModulationEntry>& modulations();

// The entry that object["type"] names. Throws params::InputError.
const DensityEntry& density_entry(const nlohmann::json& object, const params::Place& place);
const ModulationEntry& modulation_entry(const nlohmann::json& object, const params::Place& place);

// The density that `json` describes; for parameters of kind "density", nested to any depth that
// canonical_object allows. Throws params::InputError.
std::unique_ptr<Expression> density_from_json(const nlohmann::json& json,
                                              const params::Place& place);

}  // namespace morsel::geom

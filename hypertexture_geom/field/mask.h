// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "hypertexture_geom/field/expression.h"
#include "hypertexture_geom/params/json_reader.h"

namespace morsel::geom {

// A mask: a factor between 0 and 1 that depends on the position, Perlin's smooth step (2002) of a
// height or of a density: 0 up to `from`, 1 at `to` and beyond (or the other way round when from >
// to).

const std::vector<const params::Declaration*>& mask_declarations();

// The declaration that object["type"] names. Throws params::InputError.
const params::Declaration& mask_declaration(const nlohmann::json& object,
                                            const params::Place& place);

// Throws params::InputError.
std::unique_ptr<Expression> mask_from_json(const nlohmann::json& object,
                                           const params::Place& place);

// The parameter "mask" of modulations that add something, and its use: `f` times the mask when the
// scene gives one.
params::Parameter mask_parameter();
std::shared_ptr<const Expression> masked(std::shared_ptr<const Expression> f,
                                         const params::JsonReader& reader);

}  // namespace morsel::geom

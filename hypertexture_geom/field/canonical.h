// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "hypertexture_geom/params/json_reader.h"

namespace morsel::geom {

// Densities and modulations may hold one another this deep.
inline constexpr int kMaxNesting = 32;

// The object with every default filled in, numbers in one spelling and keys sorted, so that equal
// descriptions come out as equal text; likewise the objects within it whose parameters say what
// they are (params::Parameter::record and kind). Checks all of it on the way. Throws
// params::InputError, also for objects nested deeper than kMaxNesting.
nlohmann::json canonical_object(const nlohmann::json& object,
                                const params::Declaration& declaration, const params::Place& place);

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hypertexture_geom/params/json_reader.h"

namespace morsel::params {

// The declarations of a kind (Parameter::kind), by the "type" of their objects.
struct TypedDeclaration {
  std::string type;
  const Declaration* declaration;
};
using KindLookup = std::function<std::vector<TypedDeclaration>(const std::string& kind)>;

// Everything that is wrong with an object and with the records and kinds in it, as JsonReader,
// which stops at the first problem, would say it. What values mean to one another is not looked at.
std::vector<std::string> problems_of(const nlohmann::json& object, const Declaration& declaration,
                                     const Place& place, const KindLookup& kinds);

}  // namespace morsel::params

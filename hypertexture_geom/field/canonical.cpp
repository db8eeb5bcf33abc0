// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/canonical.h"

#include <fmt/format.h>

#include <stdexcept>

#include "hypertexture_geom/field/mask.h"
#include "hypertexture_geom/field/registry.h"

namespace morsel::geom {
namespace {

using nlohmann::json;
using params::Declaration;
using params::Parameter;
using params::Place;
using params::Type;

json canonical_at(const json& object, const Declaration& declaration, const Place& place,
                  int depth);

// 1 and 1.0, and 0.0 and -0.0, are the same number.
double canonical_number(const json& number) { return number.get<double>() + 0.0; }

json canonical_vector(const json& value) {
  json result = json::array();
  for (int i = 0; i < 3; ++i)
    if (value.is_number())
      result.push_back(canonical_number(value));
    else if (static_cast<std::size_t>(i) < value.size())
      result.push_back(canonical_number(value[i]));
  return result;
}

// A kObject, or an item of a kArray.
json canonical_item(const json& value, const Parameter& p, const Place& place, int depth) {
  if (p.record != nullptr) return canonical_at(value, *p.record, place, depth + 1);
  if (p.kind == "density")
    return canonical_at(value, density_entry(value, place).declaration, place, depth + 1);
  if (p.kind == "modulation")
    return canonical_at(value, modulation_entry(value, place).declaration, place, depth + 1);
  if (p.kind == "mask")
    return canonical_at(value, mask_declaration(value, place), place, depth + 1);
  if (!p.kind.empty()) throw std::logic_error("parameter of unknown kind " + p.kind);
  return value;
}

json canonical_value(const json& value, const Parameter& p, const Place& place, int depth) {
  switch (p.type) {
    case Type::kNumber:
      return canonical_number(value);
    case Type::kInteger:
      return value.is_number_float() ? json(static_cast<std::int64_t>(value.get<double>())) : value;
    case Type::kVector2:
    case Type::kVector3:
    case Type::kNumberOrVector3:
    case Type::kColor:
      return canonical_vector(value);
    case Type::kObject:
      return canonical_item(value, p, place, depth);
    case Type::kArray: {
      json result = json::array();
      for (std::size_t i = 0; i < value.size(); ++i)
        result.push_back(canonical_item(value[i], p, place / i, depth));
      return result;
    }
    default:
      return value;
  }
}

json canonical_at(const json& object, const Declaration& declaration, const Place& place,
                  int depth) {
  if (depth > kMaxNesting)
    place.fail(
        fmt::format("nested too deeply: at most {} objects may hold one another", kMaxNesting));
  const params::JsonReader checked(object, declaration, place);
  json result = json::object();
  for (const Parameter& p : declaration.parameters) {
    const auto it = object.find(p.name);
    if (it != object.end())
      result[p.name] = canonical_value(*it, p, place / p.name, depth);
    else if (!p.default_value.is_null() && params::applies(p, object, declaration))
      result[p.name] = canonical_value(p.default_value, p, place / p.name, depth);
  }
  return result;
}

}  // namespace

json canonical_object(const json& object, const Declaration& declaration, const Place& place) {
  return canonical_at(object, declaration, place, 0);
}

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/params/parameter.h"

#include <algorithm>
#include <cmath>

namespace morsel::params {
namespace {

// Levenshtein distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitution});
    }
  }
  return row[b.size()];
}

nlohmann::json vector_schema(int size) {
  return {
      {"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", size}, {"maxItems", size}};
}

// Schema of a kObject or of the items of a kArray.
nlohmann::json item_schema(const Parameter& p) {
  if (p.record != nullptr) return schema_of(*p.record);
  if (!p.kind.empty()) return {{"allOf", {{{"$ref", "#/definitions/" + p.kind}}}}};
  if (p.type == Type::kObject) return {{"type", "object"}};
  return nlohmann::json::object();
}

nlohmann::json type_schema(const Parameter& p) {
  switch (p.type) {
    case Type::kBoolean:
      return {{"type", "boolean"}};
    case Type::kInteger:
      return {{"type", "integer"}};
    case Type::kNumber:
      return {{"type", "number"}};
    case Type::kString:
      return {{"type", "string"}};
    case Type::kChoice:
      return {{"type", "string"}, {"enum", p.choices}};
    case Type::kVector2:
      return vector_schema(2);
    case Type::kVector3:
    case Type::kColor:
      return vector_schema(3);
    case Type::kNumberOrVector3: {
      nlohmann::json schema = vector_schema(3);
      schema["type"] = {"number", "array"};
      return schema;
    }
    case Type::kMatrix4:
      return {{"type", "array"}, {"items", vector_schema(4)}, {"minItems", 4}, {"maxItems", 4}};
    case Type::kObject:
      return item_schema(p);
    case Type::kArray: {
      nlohmann::json schema{{"type", "array"}, {"items", item_schema(p)}};
      if (std::isfinite(p.min)) schema["minItems"] = static_cast<std::int64_t>(p.min);
      if (std::isfinite(p.max)) schema["maxItems"] = static_cast<std::int64_t>(p.max);
      return schema;
    }
  }
  return nlohmann::json::object();
}

}  // namespace

bool applies(const Parameter& parameter, const nlohmann::json& object,
             const Declaration& declaration) {
  if (parameter.only_with.empty()) return true;
  if (const auto it = object.find(parameter.only_with); it != object.end())
    return *it == parameter.only_with_value;
  for (const Parameter& p : declaration.parameters)
    if (p.name == parameter.only_with) return p.default_value == parameter.only_with_value;
  return false;
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& known) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, name.size() / 2) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string join(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

nlohmann::json schema_of(const Declaration& declaration) {
  nlohmann::json schema = {{"type", "object"},
                           {"description", declaration.help},
                           {"additionalProperties", false},
                           {"properties", nlohmann::json::object()}};
  nlohmann::json required = nlohmann::json::array();
  for (const Parameter& p : declaration.parameters) {
    nlohmann::json property = type_schema(p);
    property["description"] = p.unit.empty() ? p.help : p.help + " [" + p.unit + "]";
    if (!p.default_value.is_null()) property["default"] = p.default_value;
    const auto add_range = [&](nlohmann::json& bounded) {
      if (std::isfinite(p.min)) bounded[p.exclusive_min ? "exclusiveMinimum" : "minimum"] = p.min;
      if (std::isfinite(p.max)) bounded["maximum"] = p.max;
    };
    const bool numbers =
        p.type != Type::kObject && p.type != Type::kArray && property.contains("type");
    if (numbers && property["type"] != "array") add_range(property);
    if (numbers && property.contains("items"))
      add_range(p.type == Type::kMatrix4 ? property["items"]["items"] : property["items"]);
    schema["properties"][p.name] = property;
    if (p.default_value.is_null() && !p.optional) required.push_back(p.name);
  }
  if (!required.empty()) schema["required"] = required;
  return schema;
}

}  // namespace morsel::params

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

// Parameters are declared once: name, type, unit, default, range and help. Validation of scene
// files, the JSON schema and the reference documentation all come from the declaration.
namespace morsel::params {

enum class Type {
  kBoolean,
  kInteger,
  kNumber,
  kString,
  kChoice,
  kVector2,
  kVector3,
  kNumberOrVector3,  // one number stands for three equal ones
  kColor,
  kMatrix4,  // 4 rows of 4 numbers
  kObject,
  kArray
};

// Coordinates and lengths of a scene are at most this far from 0. Doubles are 1e-10 apart there;
// far beyond, squares of distances lose all that a field adds to them, and then overflow.
inline constexpr double kFarthest = 1e6;

struct Declaration;

struct Parameter {
  std::string name;
  Type type = Type::kNumber;
  nlohmann::json default_value = nullptr;  // null: required unless `optional`
  std::string help = {};
  std::string unit = {};  // "length", "degrees", "1/length", "" ...
  // Of a number or of each component of a vector; of an array, the number of its items.
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool exclusive_min = false;             // value > min rather than >=
  bool optional = false;                  // may be absent without a default
  std::vector<std::string> choices = {};  // kChoice
  // What a kObject, or each item of a kArray, is: an object of this declaration, or one of a kind
  // ("density", "modulation", "mask") whose own "type" says which of that kind's declarations it
  // follows.
  const Declaration* record = nullptr;
  std::string kind = {};
  // May be given, and has its default, only where the parameter of this name has this value.
  std::string only_with = {};
  std::string only_with_value = {};
};

struct Declaration {
  std::string name;
  std::string help = {};
  std::vector<Parameter> parameters;
};

// Whether `parameter` means anything in `object`, which `declaration` describes.
bool applies(const Parameter& parameter, const nlohmann::json& object,
             const Declaration& declaration);

// The name in `known` nearest to `name` by edit distance; empty when none is near.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

// "a, b, c"
std::string join(const std::vector<std::string>& names);

// JSON Schema (draft 7) of one declared object. A kind K is referred to as "#/definitions/K".
nlohmann::json schema_of(const Declaration& declaration);

}  // namespace morsel::params

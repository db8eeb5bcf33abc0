// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "hypertexture_geom/params/parameter.h"

namespace morsel::params {

// Invalid input. what() is "FILE: /json/path: what is wrong, the value, the valid choices".
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Where in which file a JSON value stands; used in messages.
struct Place {
  std::string file;
  std::string path;  // JSON pointer, "" for the whole document

  Place operator/(std::string_view key) const;
  Place operator/(std::size_t index) const;
  [[noreturn]] void fail(const std::string& message) const;  // throws InputError
};

// Parses a JSON file (comments allowed). Throws InputError with file, line and column (see
// syntax.h), and for files that can't be read.
nlohmann::json parse_file(const std::filesystem::path& file);
nlohmann::json parse_text(const std::string& text, const std::string& name);

// One JSON object read by its declaration. The constructor checks everything: that it is an object,
// unknown keys (naming the nearest known one), missing required keys, types, ranges, choices,
// finite numbers. Getters return the value or the default; asking for an undeclared name or of
// another type is a programming error (std::logic_error).
class JsonReader {
 public:
  JsonReader(const nlohmann::json& object, const Declaration& declaration, Place place);

  bool has(std::string_view name) const;  // present in the file
  bool boolean(std::string_view name) const;
  std::int64_t integer(std::string_view name) const;
  double number(std::string_view name) const;
  std::string string(std::string_view name) const;  // kString and kChoice
  Imath::V2d vector2(std::string_view name) const;
  Imath::V3d vector3(std::string_view name) const;  // kVector3, kColor and kNumberOrVector3
  const nlohmann::json& object(std::string_view name) const;  // kObject, kArray, kMatrix4
  Place place(std::string_view name) const { return place_ / name; }
  const Place& place() const { return place_; }

 private:
  const nlohmann::json& value(std::string_view name, std::initializer_list<Type> types) const;

  const nlohmann::json& object_;
  const Declaration& declaration_;
  Place place_;
};

// The choice named by object["type"]; fails at `place` when it is missing or not among `known`.
std::string type_of(const nlohmann::json& object, const std::vector<std::string>& known,
                    const Place& place, const std::string& default_type = "");

}  // namespace morsel::params

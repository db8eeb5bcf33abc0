// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/params/json_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "hypertexture_geom/params/synonyms.h"
#include "hypertexture_geom/params/syntax.h"

namespace morsel::params {
namespace {

using nlohmann::json;

std::string shown(const json& value) {
  std::string text = value.dump();
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

const char* type_name(Type type) {
  switch (type) {
    case Type::kBoolean:
      return "true or false";
    case Type::kInteger:
      return "an integer";
    case Type::kNumber:
      return "a number";
    case Type::kString:
    case Type::kChoice:
      return "a string";
    case Type::kVector2:
      return "an array of 2 numbers";
    case Type::kVector3:
      return "an array of 3 numbers";
    case Type::kNumberOrVector3:
      return "a number or an array of 3 numbers";
    case Type::kColor:
      return "a colour: an array of 3 numbers";
    case Type::kMatrix4:
      return "4 rows of 4 numbers";
    case Type::kObject:
      return "an object";
    case Type::kArray:
      return "an array";
  }
  return "";
}

bool is_vector(const json& value, std::size_t size) {
  if (!value.is_array() || value.size() != size) return false;
  for (const json& v : value)
    if (!v.is_number()) return false;
  return true;
}

bool has_type(const json& value, Type type) {
  switch (type) {
    case Type::kBoolean:
      return value.is_boolean();
    case Type::kInteger:
      return value.is_number_integer() ||
             (value.is_number_float() && std::abs(value.get<double>()) < 9e15 &&
              value.get<double>() == std::floor(value.get<double>()));
    case Type::kNumber:
      return value.is_number();
    case Type::kString:
    case Type::kChoice:
      return value.is_string();
    case Type::kVector2:
      return is_vector(value, 2);
    case Type::kVector3:
    case Type::kColor:
      return is_vector(value, 3);
    case Type::kNumberOrVector3:
      return value.is_number() || is_vector(value, 3);
    case Type::kMatrix4:
      return value.is_array() && value.size() == 4 &&
             std::all_of(value.begin(), value.end(),
                         [](const json& row) { return is_vector(row, 4); });
    case Type::kObject:
      return value.is_object();
    case Type::kArray:
      return value.is_array();
  }
  return false;
}

std::string range_text(const Parameter& p) {
  if (std::isfinite(p.min) && std::isfinite(p.max))
    return fmt::format("between {} and {}{}", p.min, p.max,
                       p.exclusive_min ? fmt::format(", {} excluded", p.min) : "");
  if (std::isfinite(p.min))
    return fmt::format("{} {}", p.exclusive_min ? "above" : "at least", p.min);
  return fmt::format("at most {}", p.max);
}

void check_number(const Parameter& p, double x, const Place& place) {
  if (!std::isfinite(x)) place.fail("not a finite number");
  if (x < p.min || x > p.max || (p.exclusive_min && x == p.min))
    place.fail(fmt::format("{} is out of range; must be {}", x, range_text(p)));
}

void check_value(const Parameter& p, const json& value, const Place& place) {
  if (!has_type(value, p.type))
    place.fail(fmt::format("must be {}, not {}", type_name(p.type), shown(value)));
  switch (p.type) {
    case Type::kInteger:
    case Type::kNumber:
      check_number(p, value.get<double>(), place);
      break;
    case Type::kVector2:
    case Type::kVector3:
    case Type::kColor:
    case Type::kNumberOrVector3:
      if (value.is_number()) {
        check_number(p, value.get<double>(), place);
        break;
      }
      for (std::size_t i = 0; i < value.size(); ++i)
        check_number(p, value[i].get<double>(), place / i);
      break;
    case Type::kMatrix4:
      for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t c = 0; c < 4; ++c)
          check_number(p, value[r][c].get<double>(), place / r / c);
      break;
    case Type::kChoice: {
      const std::string text = value.get<std::string>();
      for (const std::string& c : p.choices)
        if (c == text) return;
      const std::string near = suggested_name(text, p.choices);
      place.fail(fmt::format("unknown value \"{}\"{}; choices: {}", text,
                             near.empty() ? "" : fmt::format(", did you mean \"{}\"?", near),
                             join(p.choices)));
    }
    case Type::kArray: {
      const double size = static_cast<double>(value.size());
      if (size < p.min || size > p.max)
        place.fail(fmt::format("has {} items; the number of items must be {}", value.size(),
                               range_text(p)));
      break;
    }
    default:
      break;
  }
}

}  // namespace

Place Place::operator/(std::string_view key) const {
  std::string escaped;
  for (const char c : key) {
    if (c == '~')
      escaped += "~0";
    else if (c == '/')
      escaped += "~1";
    else
      escaped += c;
  }
  return {file, path + "/" + escaped};
}

Place Place::operator/(std::size_t index) const {
  return {file, path + "/" + std::to_string(index)};
}

void Place::fail(const std::string& message) const {
  throw InputError(file + ": " + (path.empty() ? "" : path + ": ") + message);
}

json parse_text(const std::string& text, const std::string& name) {
  if (const std::string problem = syntax_problem(text); !problem.empty())
    throw InputError(name + ": " + problem);
  return json::parse(text, nullptr, true, true);
}

json parse_file(const std::filesystem::path& file) {
  std::error_code ec;
  if (std::filesystem::is_directory(file, ec))
    throw InputError(file.string() + ": is a directory, not a file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file.string() + ": cannot open: " + std::strerror(errno));
  std::ostringstream text;
  text << in.rdbuf();
  if (in.bad()) throw InputError(file.string() + ": cannot read");
  return parse_text(text.str(), file.string());
}

JsonReader::JsonReader(const json& object, const Declaration& declaration, Place place)
    : object_(object), declaration_(declaration), place_(std::move(place)) {
  if (!object.is_object())
    place_.fail(fmt::format("must be an object ({}), not {}", declaration.name, shown(object)));
  std::vector<std::string> known;
  for (const Parameter& p : declaration.parameters) known.push_back(p.name);
  for (const auto& item : object.items()) {
    bool found = false;
    for (const std::string& name : known) found = found || name == item.key();
    if (found) continue;
    const std::string near = suggested_name(item.key(), known);
    (place_ / item.key())
        .fail(fmt::format("unknown key of {}{}; known keys: {}", declaration.name,
                          near.empty() ? "" : fmt::format(", did you mean \"{}\"?", near),
                          join(known)));
  }
  for (const Parameter& p : declaration.parameters) {
    const auto it = object.find(p.name);
    if (it != object.end()) {
      check_value(p, *it, place_ / p.name);
      if (!applies(p, object, declaration))
        (place_ / p.name)
            .fail(
                fmt::format("applies only where \"{}\" is \"{}\"", p.only_with, p.only_with_value));
    } else if (p.default_value.is_null() && !p.optional) {
      place_.fail(fmt::format("missing key \"{}\" of {} ({})", p.name, declaration.name, p.help));
    }
  }
}

bool JsonReader::has(std::string_view name) const { return object_.contains(name); }

const json& JsonReader::value(std::string_view name, std::initializer_list<Type> types) const {
  for (const Parameter& p : declaration_.parameters) {
    if (p.name != name) continue;
    bool right_type = false;
    for (const Type t : types) right_type = right_type || t == p.type;
    if (!right_type)
      throw std::logic_error(fmt::format("{}.{} read as another type", declaration_.name, name));
    const auto it = object_.find(name);
    if (it != object_.end()) return *it;
    if (p.default_value.is_null())
      throw std::logic_error(fmt::format("{}.{} read though absent", declaration_.name, name));
    return p.default_value;
  }
  throw std::logic_error(fmt::format("{}.{} is not declared", declaration_.name, name));
}

bool JsonReader::boolean(std::string_view name) const {
  return value(name, {Type::kBoolean}).get<bool>();
}

std::int64_t JsonReader::integer(std::string_view name) const {
  const json& v = value(name, {Type::kInteger});
  return v.is_number_float() ? static_cast<std::int64_t>(v.get<double>()) : v.get<std::int64_t>();
}

double JsonReader::number(std::string_view name) const {
  return value(name, {Type::kNumber}).get<double>();
}

std::string JsonReader::string(std::string_view name) const {
  return value(name, {Type::kString, Type::kChoice}).get<std::string>();
}

Imath::V2d JsonReader::vector2(std::string_view name) const {
  const json& v = value(name, {Type::kVector2});
  return {v[0].get<double>(), v[1].get<double>()};
}

Imath::V3d JsonReader::vector3(std::string_view name) const {
  const json& v = value(name, {Type::kVector3, Type::kColor, Type::kNumberOrVector3});
  if (v.is_number()) return Imath::V3d(v.get<double>());
  return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
}

const json& JsonReader::object(std::string_view name) const {
  return value(name, {Type::kObject, Type::kArray, Type::kMatrix4});
}

std::string type_of(const json& object, const std::vector<std::string>& known, const Place& place,
                    const std::string& default_type) {
  if (!object.is_object()) place.fail(fmt::format("must be an object, not {}", shown(object)));
  const auto it = object.find("type");
  if (it == object.end()) {
    if (!default_type.empty()) return default_type;
    place.fail(fmt::format("missing key \"type\"; choices: {}", join(known)));
  }
  Parameter p{.name = "type",
              .type = Type::kChoice,
              .default_value = nullptr,
              .help = "",
              .choices = known};
  check_value(p, *it, place / "type");
  return it->get<std::string>();
}

}  // namespace morsel::params

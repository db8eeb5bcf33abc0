// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/params/reference.h"

#include <fmt/format.h>

#include <cmath>

namespace morsel::params {
namespace {

std::string plural(const std::string& noun) {
  return noun.ends_with('y') ? noun.substr(0, noun.size() - 1) + "ies" : noun + "s";
}

std::string type_text(const Parameter& p) {
  switch (p.type) {
    case Type::kBoolean:
      return "true or false";
    case Type::kInteger:
      return "integer";
    case Type::kNumber:
      return "number";
    case Type::kString:
      return "text";
    case Type::kChoice: {
      std::string text;
      for (const std::string& c : p.choices)
        text += fmt::format("{}`{}`", text.empty() ? "" : " or ", c);
      return text;
    }
    case Type::kVector2:
      return "2 numbers";
    case Type::kVector3:
      return "3 numbers";
    case Type::kNumberOrVector3:
      return "number or 3 numbers";
    case Type::kColor:
      return "colour, 3 numbers";
    case Type::kMatrix4:
      return "4 rows of 4 numbers";
    case Type::kObject:
      return p.record != nullptr ? p.record->name : p.kind.empty() ? "object" : p.kind;
    case Type::kArray:
      if (p.record != nullptr) return "list of " + plural(p.record->name);
      return "list of " + plural(p.kind.empty() ? "value" : p.kind);
  }
  return "";
}

std::string number_text(double x) { return fmt::format("{:.15g}", x); }

std::string range_text(const Parameter& p) {
  const bool low = std::isfinite(p.min), high = std::isfinite(p.max);
  const std::string what = p.type == Type::kArray ? " items" : "";
  if (low && high)
    return fmt::format("{}{} to {}{}", p.exclusive_min ? "above " : "", number_text(p.min),
                       number_text(p.max), what);
  if (low)
    return fmt::format("{} {}{}", p.exclusive_min ? "above" : "at least", number_text(p.min), what);
  if (high) return fmt::format("at most {}{}", number_text(p.max), what);
  return "";
}

std::string default_text(const Parameter& p) {
  if (p.default_value.is_null()) return p.optional ? "none" : "required";
  if (p.default_value.is_number()) return number_text(p.default_value.get<double>());
  if (p.default_value.is_array() && !p.default_value.empty()) {
    std::string text;
    for (const auto& item : p.default_value)
      text += fmt::format("{}{}", text.empty() ? "" : ", ",
                          item.is_number() ? number_text(item.get<double>()) : item.dump());
    return fmt::format("[{}]", text);
  }
  if (p.default_value.is_string()) return fmt::format("`{}`", p.default_value.get<std::string>());
  return p.default_value.dump();
}

std::string help_text(const Parameter& p) {
  std::string text;
  for (const char c : p.help) {
    if (c == '|') text += '\\';
    text += c;
  }
  if (!p.only_with.empty())
    text += fmt::format(" Only where `{}` is `{}`.", p.only_with, p.only_with_value);
  return text;
}

}  // namespace

std::string reference_of(const Declaration& declaration, int heading_level) {
  std::string text = fmt::format("{} `{}`\n\n{}\n", std::string(heading_level, '#'),
                                 declaration.name, declaration.help);
  std::string rows, records;
  for (const Parameter& p : declaration.parameters) {
    if (p.record != nullptr)
      records += fmt::format("\n{}", reference_of(*p.record, heading_level + 1));
    if (p.name == "type") continue;
    rows += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", p.name, type_text(p), p.unit,
                        default_text(p), range_text(p), help_text(p));
  }
  if (!rows.empty())
    text +=
        "\n| parameter | type | unit | default | range | what it is "
        "|\n|---|---|---|---|---|---|\n" +
        rows;
  return text + records;
}

}  // namespace morsel::params

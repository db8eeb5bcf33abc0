// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/overrides.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

namespace morsel::render {
namespace {

using nlohmann::json;

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (;;) {
    const std::size_t end = path.find('.', begin);
    parts.push_back(path.substr(begin, end - begin));
    if (end == std::string::npos) return parts;
    begin = end + 1;
  }
}

std::optional<std::size_t> parse_index(const std::string& text) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return index;
}

// The element of `array` with this "name", else with this index.
std::size_t find_element(const json& array, const std::string& key, const Override& change,
                         const params::Place& place) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < array.size(); ++i) {
    if (!array[i].is_object()) continue;
    const auto name = array[i].find("name");
    if (name == array[i].end() || !name->is_string()) continue;
    if (*name == key) return i;
    names.push_back(name->get<std::string>());
  }
  const std::optional<std::size_t> index = parse_index(key);
  if (index && *index < array.size()) return *index;

  const std::string near = params::nearest_name(key, names);
  place.fail(fmt::format("no element \"{}\" in this array of {}{}{} ({})", key, array.size(),
                         near.empty() ? "" : fmt::format(", did you mean \"{}\"?", near),
                         names.empty() ? "" : "; names: " + params::join(names), change.source));
}

bool is_utf8(const std::string& text) {
  try {
    json(text).dump();
  } catch (const json::type_error&) {
    return false;
  }
  return true;
}

}  // namespace

Override parse_override(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw params::InputError(
        fmt::format("--set {}: must be path=value, as in --set render.spp=16", text));
  // What is no text cannot be named in messages, nor be part of a scene, which is JSON.
  if (!is_utf8(text))
    throw params::InputError("--set: must be UTF-8: " +
                             json(text).dump(-1, ' ', false, json::error_handler_t::replace));
  Override change;
  change.path = text.substr(0, equals);
  change.source = "--set " + text;
  for (const std::string& part : split(change.path))
    if (part.empty())
      throw params::InputError(
          fmt::format("--set {}: the path \"{}\" has an empty part", text, change.path));
  const std::string value = text.substr(equals + 1);
  change.value = json::parse(value, nullptr, false);
  if (change.value.is_discarded()) change.value = value;
  return change;
}

std::string apply_override(json& root, const Override& change, const params::Place& file) {
  json* value = &root;
  params::Place place = file;
  std::string outermost;  // of what is made here
  for (const std::string& key : split(change.path)) {
    if (value->is_array()) {
      const std::size_t index = find_element(*value, key, change, place);
      value = &(*value)[index];
      place = place / index;
    } else if (value->is_object() || value->is_null()) {
      const bool known = value->contains(key);
      value = &(*value)[key];
      place = place / std::string_view(key);
      if (!known && outermost.empty()) outermost = place.path;
    } else {
      place.fail(
          fmt::format("is {}, so it has no \"{}\" to set ({})", value->dump(), key, change.source));
    }
  }
  *value = change.value;
  return outermost.empty() ? place.path : outermost;
}

}  // namespace morsel::render

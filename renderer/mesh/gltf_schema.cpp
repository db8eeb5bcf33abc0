// SPDX-License-Identifier: Apache-2.0
#include "renderer/mesh/gltf_schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "renderer/mesh/gltf_accessor.h"

namespace morsel::render {
namespace {

using nlohmann::json;

enum class Type { kIndex, kNumber, kString, kBoolean, kObject, kIndices, kNumbers, kStrings };

// A place by its keys, "*" being every element of an array, and what may be there.
struct Rule {
  std::string_view place;
  Type type;
};

constexpr Rule kRules[] = {
    {"asset/version", Type::kString},
    {"scene", Type::kIndex},
    {"extensionsUsed", Type::kStrings},
    {"extensionsRequired", Type::kStrings},
    {"scenes/*/name", Type::kString},
    {"scenes/*/nodes", Type::kIndices},
    {"nodes/*/name", Type::kString},
    {"nodes/*/children", Type::kIndices},
    {"nodes/*/mesh", Type::kIndex},
    {"nodes/*/camera", Type::kIndex},
    {"nodes/*/matrix", Type::kNumbers},
    {"nodes/*/translation", Type::kNumbers},
    {"nodes/*/rotation", Type::kNumbers},
    {"nodes/*/scale", Type::kNumbers},
    {"nodes/*/extensions/KHR_lights_punctual/light", Type::kIndex},
    {"meshes/*/name", Type::kString},
    {"meshes/*/primitives/*/attributes", Type::kObject},
    {"meshes/*/primitives/*/indices", Type::kIndex},
    {"meshes/*/primitives/*/material", Type::kIndex},
    {"meshes/*/primitives/*/mode", Type::kIndex},
    {"accessors/*/bufferView", Type::kIndex},
    {"accessors/*/byteOffset", Type::kIndex},
    {"accessors/*/componentType", Type::kIndex},
    {"accessors/*/normalized", Type::kBoolean},
    {"accessors/*/count", Type::kIndex},
    {"accessors/*/type", Type::kString},
    {"accessors/*/min", Type::kNumbers},
    {"accessors/*/max", Type::kNumbers},
    {"accessors/*/sparse/count", Type::kIndex},
    {"accessors/*/sparse/indices/bufferView", Type::kIndex},
    {"accessors/*/sparse/values/bufferView", Type::kIndex},
    {"bufferViews/*/buffer", Type::kIndex},
    {"bufferViews/*/byteOffset", Type::kIndex},
    {"bufferViews/*/byteLength", Type::kIndex},
    {"bufferViews/*/byteStride", Type::kIndex},
    {"buffers/*/byteLength", Type::kIndex},
    {"buffers/*/uri", Type::kString},
    {"images/*/uri", Type::kString},
    {"images/*/mimeType", Type::kString},
    {"images/*/bufferView", Type::kIndex},
    {"textures/*/source", Type::kIndex},
    {"textures/*/sampler", Type::kIndex},
    {"samplers/*/wrapS", Type::kIndex},
    {"samplers/*/wrapT", Type::kIndex},
    {"materials/*/name", Type::kString},
    {"materials/*/alphaMode", Type::kString},
    {"materials/*/alphaCutoff", Type::kNumber},
    {"materials/*/doubleSided", Type::kBoolean},
    {"materials/*/emissiveFactor", Type::kNumbers},
    {"materials/*/pbrMetallicRoughness/baseColorFactor", Type::kNumbers},
    {"materials/*/pbrMetallicRoughness/metallicFactor", Type::kNumber},
    {"materials/*/pbrMetallicRoughness/roughnessFactor", Type::kNumber},
    {"materials/*/normalTexture/scale", Type::kNumber},
    {"cameras/*/type", Type::kString},
    {"cameras/*/perspective/yfov", Type::kNumber},
    {"cameras/*/orthographic/ymag", Type::kNumber},
};

constexpr std::string_view kTextures[] = {
    "materials/*/pbrMetallicRoughness/baseColorTexture",
    "materials/*/pbrMetallicRoughness/metallicRoughnessTexture", "materials/*/normalTexture",
    "materials/*/occlusionTexture", "materials/*/emissiveTexture"};
constexpr Rule kTextureRules[] = {
    {"/index", Type::kIndex},
    {"/texCoord", Type::kIndex},
    {"/extensions/KHR_texture_transform/offset", Type::kNumbers},
    {"/extensions/KHR_texture_transform/scale", Type::kNumbers},
    {"/extensions/KHR_texture_transform/rotation", Type::kNumber},
    {"/extensions/KHR_texture_transform/texCoord", Type::kIndex},
};

// Some files have whole numbers as 5.0.
bool is_index(const json& v) {
  if (!v.is_number()) return false;
  const double x = v.get<double>();
  return x >= 0.0 && x == std::floor(x);
}

bool all(const json& v, bool (*good)(const json&)) {
  if (!v.is_array()) return false;
  for (const json& element : v)
    if (!good(element)) return false;
  return true;
}

bool fits(const json& v, Type type) {
  switch (type) {
    case Type::kIndex:
      return is_index(v);
    case Type::kNumber:
      return v.is_number();
    case Type::kString:
      return v.is_string();
    case Type::kBoolean:
      return v.is_boolean();
    case Type::kObject:
      return v.is_object();
    case Type::kIndices:
      return all(v, is_index);
    case Type::kNumbers:
      return all(v, [](const json& e) { return e.is_number(); });
    case Type::kStrings:
      return all(v, [](const json& e) { return e.is_string(); });
  }
  return true;
}

const char* name_of(Type type) {
  switch (type) {
    case Type::kIndex:
      return "a whole number, 0 or more";
    case Type::kNumber:
      return "a number";
    case Type::kString:
      return "a string";
    case Type::kBoolean:
      return "true or false";
    case Type::kObject:
      return "an object";
    case Type::kIndices:
      return "an array of whole numbers, 0 or more";
    case Type::kNumbers:
      return "an array of numbers";
    case Type::kStrings:
      return "an array of strings";
  }
  return "";
}

[[noreturn]] void fail(const std::string& place, const char* expected, const json& value) {
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  throw GltfError(fmt::format("{} must be {}, not {}", place, expected, text));
}

void check(const json& value, const std::string& place, std::string_view rest, Type type) {
  if (rest.empty()) {
    if (!fits(value, type)) fail(place, name_of(type), value);
    return;
  }
  const std::string_view key = rest.substr(0, rest.find('/'));
  rest.remove_prefix(std::min(rest.size(), key.size() + 1));
  if (key == "*") {
    if (!value.is_array()) fail(place, "an array", value);
    for (std::size_t i = 0; i < value.size(); ++i)
      check(value[i], fmt::format("{}/{}", place, i), rest, type);
    return;
  }
  if (!value.is_object()) fail(place.empty() ? "the whole" : place, "an object", value);
  const auto found = value.find(key);
  if (found != value.end()) check(*found, fmt::format("{}/{}", place, key), rest, type);
}

// What an image says of where its bytes are, followed from one index to the next.
double number_in(const json& object, const char* key, double if_absent) {
  return object.is_object() ? object.value(key, if_absent) : if_absent;
}
const json& element_of(const json& root, const char* array, const json& object, const char* key,
                       const std::string& place) {
  const double index = object[key].get<double>();
  const auto found = root.find(array);
  const std::size_t count = found == root.end() ? 0 : found->size();
  if (!(index < static_cast<double>(count)))
    throw GltfError(
        fmt::format("{}/{} is {}, but there are {} {}", place, key, index, count, array));
  return (*found)[static_cast<std::size_t>(index)];
}

// tinygltf copies the bytes of an image that lies in a buffer without a look at where that ends.
void check_images_in_buffers(const json& root) {
  const auto images = root.find("images");
  if (images == root.end()) return;
  for (std::size_t i = 0; i < images->size(); ++i) {
    const json& image = (*images)[i];
    if (!image.contains("bufferView")) continue;
    const std::string place = fmt::format("/images/{}", i);
    const json& view = element_of(root, "bufferViews", image, "bufferView", place);
    if (!view.is_object() || !view.contains("buffer"))
      throw GltfError(place + " is in a buffer view without a buffer");
    const json& buffer = element_of(root, "buffers", view, "buffer", place + "/bufferView");
    const double end = number_in(view, "byteOffset", 0.0) + number_in(view, "byteLength", 0.0);
    const double size = number_in(buffer, "byteLength", 0.0);
    if (end > size)
      throw GltfError(fmt::format("{} ends at byte {} of a buffer that has {}", place, end, size));
  }
}

}  // namespace

void check_gltf_types(const std::string& text) {
  const json root = json::parse(text, nullptr, false);
  if (root.is_discarded() || !root.is_object()) return;
  // Other versions are refused as such.
  const auto version = root.value(json::json_pointer("/asset/version"), json("2"));
  if (!version.is_string() || version.get<std::string>().rfind("2", 0) != 0) return;
  for (const Rule& rule : kRules) check(root, "", rule.place, rule.type);
  for (const std::string_view texture : kTextures)
    for (const Rule& rule : kTextureRules)
      check(root, "", std::string(texture).append(rule.place), rule.type);
  check_images_in_buffers(root);
}

}  // namespace morsel::render

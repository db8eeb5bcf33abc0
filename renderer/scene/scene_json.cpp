// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/scene_json.h"

#include <fmt/format.h>

#include "renderer/scene/declarations.h"

namespace morsel::render {

using nlohmann::json;
using params::Place;

SceneDocument::SceneDocument(const std::filesystem::path& file,
                             const std::vector<Override>& overrides)
    : file_(file), root_(params::parse_file(file)) {
  if (!root_.is_object()) place().fail("a scene must be a JSON object");
  for (const Override& change : overrides)
    applied_.push_back({apply_override(root_, change, place()), change.source});
  explain([&] {
    if (!root_.contains("morsel"))
      place().fail("missing key \"morsel\"; a scene file begins with \"morsel\": 1");
    params::JsonReader(root_, scene_declaration(), place());
  });
}

std::filesystem::path SceneDocument::resolve(const std::string& name) const {
  return file_.parent_path() / name;
}

std::string SceneDocument::with_override(const std::string& message) const {
  // Messages begin with "FILE: POINTER": see params::Place.
  for (auto applied = applied_.rbegin(); applied != applied_.rend(); ++applied) {
    const std::string prefix = file_.string() + ": " + applied->pointer;
    if (message.compare(0, prefix.size(), prefix) != 0) continue;
    const char next = message.size() > prefix.size() ? message[prefix.size()] : ':';
    if (next != ':' && next != '/') continue;
    const std::string note = " (set by " + applied->source + ")";
    return message.find(note) == std::string::npos ? message + note : message;
  }
  return message;
}

const std::vector<std::string>& geometry_types() {
  static const std::vector<std::string> types{"hypertexture", "mesh", "rectangle", "sphere"};
  return types;
}

std::vector<GeometryEntry> list_geometries(const SceneDocument& document) {
  return document.explain([&] {
    const Place place = document.place() / "geometries";
    std::vector<GeometryEntry> entries;
    const auto section = document.root().find("geometries");
    if (section == document.root().end()) return entries;
    for (std::size_t i = 0; i < section->size(); ++i) {
      const json& object = (*section)[i];
      GeometryEntry entry;
      entry.index = i;
      entry.type = params::type_of(object, geometry_types(), place / i);
      const auto name = object.find("name");
      if (name == object.end()) (place / i).fail("missing key \"name\" of the geometry");
      if (!name->is_string() || name->get<std::string>().empty())
        (place / i / "name").fail("must be a string that is not empty, not " + name->dump());
      entry.name = name->get<std::string>();
      for (const GeometryEntry& other : entries)
        if (other.name == entry.name)
          (place / i / "name")
              .fail(fmt::format("\"{}\" is also the name of geometry {}", entry.name, other.index));
      entries.push_back(std::move(entry));
    }
    return entries;
  });
}

GeometryEntry find_hypertexture(const SceneDocument& document, const std::string& name) {
  std::vector<std::string> names;
  std::vector<GeometryEntry> found;
  for (const GeometryEntry& entry : list_geometries(document)) {
    if (!name.empty() && entry.name == name && entry.type != "hypertexture")
      (document.place() / "geometries" / entry.index)
          .fail(fmt::format("geometry \"{}\" is a {}, not a hypertexture", name, entry.type));
    if (entry.type != "hypertexture") continue;
    if (entry.name == name) return entry;
    names.push_back(entry.name);
    found.push_back(entry);
  }
  const Place place = document.place() / "geometries";
  if (names.empty()) place.fail("the scene has no hypertexture geometry");
  if (name.empty()) {
    if (found.size() == 1) return found.front();
    place.fail("the scene has several hypertexture geometries, name one of them: " +
               params::join(names));
  }
  const std::string near = params::nearest_name(name, names);
  place.fail(fmt::format("no hypertexture geometry \"{}\"{}; there are: {}", name,
                         near.empty() ? "" : fmt::format(", did you mean \"{}\"?", near),
                         params::join(names)));
}

namespace {

// A file named at `place` that Morsel may write: relative to the scene's folder and within it, so
// that a scene from elsewhere cannot write anywhere. A name that an override set may be anything,
// since it is the user's.
std::filesystem::path resolve_for_writing(const SceneDocument& document, const std::string& name,
                                          const Place& place) {
  const std::filesystem::path path(name);
  // By the names alone: what a link in the scene's folder points to was put there by its owner.
  const std::filesystem::path normal = path.lexically_normal();
  const bool leaves = path.is_absolute() || (!normal.empty() && *normal.begin() == "..");
  const std::string message = fmt::format(
      "\"{}\" is outside of the scene's folder, where scenes cannot write; a file in it or below, "
      "or any file by a flag (--cache, --set)",
      name);
  const std::string whole = fmt::format("{}: {}: {}", place.file, place.path, message);
  const bool by_the_user = document.with_override(whole) != whole;
  if (leaves && !by_the_user) place.fail(message);
  return document.resolve(name);
}

}  // namespace

geom::Hypertexture read_hypertexture(const SceneDocument& document, const GeometryEntry& entry,
                                     const topology::Execution& execution) {
  return document.explain([&] {
    geom::Hypertexture hypertexture =
        geom::hypertexture_from_json(document.root()["geometries"][entry.index],
                                     document.place() / "geometries" / entry.index, execution);
    if (!hypertexture.cache.empty())
      hypertexture.cache =
          resolve_for_writing(document, hypertexture.cache,
                              document.place() / "geometries" / entry.index / "cache")
              .string();
    return hypertexture;
  });
}

std::shared_ptr<const geom::Field> read_field(const SceneDocument& document,
                                              const GeometryEntry& entry) {
  return document.explain([&] {
    const params::JsonReader reader(document.root()["geometries"][entry.index],
                                    geom::hypertexture_declaration(),
                                    document.place() / "geometries" / entry.index);
    return geom::field_from_json(reader.object("field"), reader.place("field"));
  });
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "hypertexture_geom/field/field.h"
#include "hypertexture_geom/params/json_reader.h"
#include "renderer/scene/overrides.h"

// The part of reading a scene that needs neither Embree nor OpenImageIO: `morsel cache` and `morsel
// field` start in milliseconds because they use no more than this.
namespace morsel::render {

// A parsed scene file with its overrides applied; its sections are known to be objects and arrays,
// what is in them is not checked yet.
class SceneDocument {
 public:
  // Throws params::InputError that names the file and, where one is to blame, the override.
  SceneDocument(const std::filesystem::path& file, const std::vector<Override>& overrides);

  const std::filesystem::path& file() const { return file_; }
  const nlohmann::json& root() const { return root_; }
  params::Place place() const { return {file_.string(), ""}; }

  // A file named in the scene: relative to the folder of the scene file.
  std::filesystem::path resolve(const std::string& name) const;

  // Calls read() and returns its result; an InputError about a value that an override set, or about
  // something in it, gets the override added to its message.
  template <class Read>
  decltype(auto) explain(Read&& read) const {
    try {
      return std::forward<Read>(read)();
    } catch (const params::InputError& e) {
      throw params::InputError(with_override(e.what()));
    }
  }

  // `message` with the override that is to blame for it, if one is.
  std::string with_override(const std::string& message) const;

 private:
  struct Applied {
    std::string pointer;
    std::string source;
  };

  std::filesystem::path file_;
  nlohmann::json root_;
  std::vector<Applied> applied_;
};

// One element of "geometries".
struct GeometryEntry {
  std::size_t index = 0;
  std::string name;
  std::string type;  // one of geometry_types()
};

const std::vector<std::string>& geometry_types();

// Every geometry with its name and type checked, names distinct. Throws params::InputError.
std::vector<GeometryEntry> list_geometries(const SceneDocument& document);

// The hypertexture geometry called `name`, or the only one when `name` is empty. Throws
// params::InputError that names the ones there are.
GeometryEntry find_hypertexture(const SceneDocument& document, const std::string& name);

// Everything about a hypertexture geometry; deriving its box can take seconds. `cache` is empty or
// resolved against the scene's folder. Throws params::InputError and topology::Cancelled.
geom::Hypertexture read_hypertexture(const SceneDocument& document, const GeometryEntry& entry,
                                     const topology::Execution& execution = {});

// Only its field: takes no time.
std::shared_ptr<const geom::Field> read_field(const SceneDocument& document,
                                              const GeometryEntry& entry);

}  // namespace morsel::render

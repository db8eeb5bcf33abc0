// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/scene_reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "hypertexture_geom/field/field.h"
#include "hypertexture_geom/field/field_reference.h"
#include "hypertexture_geom/field/mask.h"
#include "hypertexture_geom/field/registry.h"
#include "hypertexture_geom/params/problems.h"
#include "hypertexture_geom/params/reference.h"
#include "renderer/scene/declarations.h"

namespace morsel::render {
namespace {

using nlohmann::json;
using params::Declaration;

// The objects of a list, told apart by their "type".
struct Kind {
  const char* name;  // as Parameter::kind has it
  const char* title;
  const char* text;
  std::vector<const Declaration*> declarations;
};

std::vector<Kind> kinds() {
  return {
      {"material",
       "Materials",
       "Items of the list `materials`, by their `type`.",
       {&diffuse_declaration(), &conductor_declaration(), &dielectric_declaration(),
        &principled_declaration()}},
      {"texture",
       "Textures",
       "Items of the list `textures`, by their `type`.",
       {&image_texture_declaration(), &ramp_texture_declaration(), &checker_texture_declaration()}},
      {"geometry",
       "Geometries",
       "Items of the list `geometries`, by their `type`. The type `hypertexture` has a "
       "[reference of its own](../hypertexture_geom/PARAMETERS.md).",
       {&mesh_declaration(), &rectangle_declaration(), &sphere_declaration()}},
      {"light",
       "Lights",
       "Items of the list `lights`, by their `type`.",
       {&environment_light_declaration(), &sky_light_declaration(), &rectangle_light_declaration(),
        &disk_light_declaration(), &sphere_light_declaration(), &point_light_declaration(),
        &distant_light_declaration()}}};
}

// The scene itself, whose parts have sections of their own.
Declaration scene_without_parts() {
  Declaration scene = scene_declaration();
  for (params::Parameter& p : scene.parameters)
    if (p.record != nullptr) p.kind = std::exchange(p.record, nullptr)->name;
  return scene;
}

// What its "type" must be: the only choice of a declaration that declares one.
std::string type_of_objects(const Declaration& declaration) {
  for (const params::Parameter& p : declaration.parameters)
    if (p.name == "type" && p.choices.size() == 1) return p.choices.front();
  throw std::logic_error(declaration.name + " has no type of its own");
}

json typed(json schema, const std::string& type) {
  schema["title"] = type;
  schema["properties"]["type"] = {{"const", type}};
  json& required = schema["required"];
  if (required.is_null()) required = json::array();
  if (std::find(required.begin(), required.end(), "type") == required.end())
    required.push_back("type");
  return schema;
}

}  // namespace

namespace {

std::vector<params::TypedDeclaration> declarations_of(const std::string& name) {
  std::vector<params::TypedDeclaration> found;
  if (name == "density")
    for (const geom::DensityEntry& d : geom::densities())
      found.push_back({d.declaration.name, &d.declaration});
  if (name == "modulation")
    for (const geom::ModulationEntry& m : geom::modulations())
      found.push_back({m.declaration.name, &m.declaration});
  if (name == "mask")
    for (const Declaration* d : geom::mask_declarations()) found.push_back({d->name, d});
  // In the loader's order of geometries, which messages list.
  if (name == "geometry") found.push_back({"hypertexture", &geom::hypertexture_declaration()});
  for (const Kind& kind : kinds())
    if (name == kind.name)
      for (const Declaration* d : kind.declarations) found.push_back({type_of_objects(*d), d});
  return found;
}

}  // namespace

std::vector<std::string> declared_problems(const SceneDocument& document) {
  std::vector<std::string> problems =
      params::problems_of(document.root(), scene_declaration(), document.place(), declarations_of);
  for (std::string& problem : problems) problem = document.with_override(problem);
  return problems;
}

std::string scene_reference() {
  std::string text =
      "# Reference of scene files\n\n"
      "Generated from the declarations in `renderer/scene/`, which are also what scene files are "
      "checked by. After a change:\n"
      "`MORSEL_UPDATE_REFERENCE=1 build/release/bin/scene_reference_test`. "
      "[README.md](README.md) says how the parts work together.\n\n";
  const Declaration scene = scene_without_parts();
  for (const Declaration* d : {&scene, &camera_declaration(), &render_declaration(),
                               &instance_declaration(), &model_declaration()})
    text += params::reference_of(*d, 2) + "\n";
  for (const Kind& kind : kinds()) {
    text += fmt::format("## {}\n\n{}\n\n", kind.title, kind.text);
    for (const Declaration* d : kind.declarations) text += params::reference_of(*d, 3) + "\n";
  }
  text.pop_back();
  return text;
}

json scene_schema() {
  json schema = params::schema_of(scene_declaration());
  schema["$schema"] = "http://json-schema.org/draft-07/schema#";
  schema["title"] = "Morsel scene";
  json hypertexture = geom::hypertexture_schema();
  json definitions = hypertexture["definitions"];
  hypertexture.erase("definitions");
  for (const Kind& kind : kinds()) {
    json choices = json::array();
    if (std::string(kind.name) == "geometry")
      choices.push_back(typed(hypertexture, "hypertexture"));
    for (const Declaration* d : kind.declarations)
      choices.push_back(typed(params::schema_of(*d), type_of_objects(*d)));
    definitions[kind.name] = {{"oneOf", std::move(choices)}};
  }
  schema["definitions"] = std::move(definitions);
  return schema;
}

}  // namespace morsel::render

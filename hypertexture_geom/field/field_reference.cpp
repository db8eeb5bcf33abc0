// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/field_reference.h"

#include <fmt/format.h>

#include <vector>

#include "hypertexture_geom/field/field.h"
#include "hypertexture_geom/field/mask.h"
#include "hypertexture_geom/field/registry.h"
#include "hypertexture_geom/params/reference.h"

namespace morsel::geom {
namespace {

using nlohmann::json;
using params::Declaration;

std::vector<const Declaration*> density_declarations() {
  std::vector<const Declaration*> all;
  for (const DensityEntry& d : densities()) all.push_back(&d.declaration);
  return all;
}

std::vector<const Declaration*> modulation_declarations() {
  std::vector<const Declaration*> all;
  for (const ModulationEntry& m : modulations()) all.push_back(&m.declaration);
  return all;
}

std::string section(const char* title, const char* text,
                    const std::vector<const Declaration*>& declarations) {
  std::string r = fmt::format("\n## {}\n\n{}\n", title, text);
  for (const Declaration* d : declarations) r += fmt::format("\n{}", params::reference_of(*d, 3));
  return r;
}

// One of these, by the value of "type".
json one_of(const std::vector<const Declaration*>& declarations) {
  json choices = json::array();
  for (const Declaration* d : declarations) {
    json schema = params::schema_of(*d);
    schema["title"] = d->name;
    schema["properties"]["type"] = {{"const", d->name}};
    if (!schema.contains("required")) schema["required"] = json::array();
    schema["required"].push_back("type");
    choices.push_back(std::move(schema));
  }
  return {{"oneOf", std::move(choices)}};
}

}  // namespace

std::string field_reference() {
  return "# Parameters of a hypertexture\n\n"
         "Generated from the declarations in `field/`, which are also what scene files are checked "
         "by. After a change:\n"
         "`MORSEL_UPDATE_REFERENCE=1 build/release/bin/field_test "
         "--gtest_filter='FieldReference.*'`.\n\n" +
         params::reference_of(hypertexture_declaration(), 2) +
         section("Densities", "The object `density`; its `type` is one of these.",
                 density_declarations()) +
         section("Modulations", "Items of the list `modulations`, by their `type`.",
                 modulation_declarations()) +
         section("Masks", "The object `mask` of some modulations, by its `type`.",
                 mask_declarations());
}

json hypertexture_schema() {
  json schema = params::schema_of(hypertexture_declaration());
  schema["definitions"] = {{"density", one_of(density_declarations())},
                           {"modulation", one_of(modulation_declarations())},
                           {"mask", one_of(mask_declarations())}};
  return schema;
}

}  // namespace morsel::geom

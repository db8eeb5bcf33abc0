// SPDX-License-Identifier: Apache-2.0
// The parameter reference and the JSON Schema, both from the declarations.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "hypertexture_geom/field/field_reference.h"
#include "hypertexture_geom/field/mask.h"
#include "hypertexture_geom/field/registry.h"

namespace morsel::geom {
namespace {

using nlohmann::json;

TEST(FieldReference, ThePageIsUpToDate) {
  const std::string path = std::string(MORSEL_SOURCE_DIR) + "/hypertexture_geom/PARAMETERS.md";
  const std::string expected = field_reference();
  if (std::getenv("MORSEL_UPDATE_REFERENCE") != nullptr) std::ofstream(path) << expected;
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_TRUE(text.str() == expected)
      << path << " is not what the declarations say: run this test with MORSEL_UPDATE_REFERENCE=1";
}

TEST(FieldReference, EveryParameterIsDescribed) {
  std::vector<const params::Declaration*> all = mask_declarations();
  for (const DensityEntry& d : densities()) all.push_back(&d.declaration);
  for (const ModulationEntry& m : modulations()) all.push_back(&m.declaration);
  const std::string page = field_reference();
  for (const params::Declaration* d : all) {
    EXPECT_NE(page.find("### `" + d->name + "`\n\n" + d->help), std::string::npos) << d->name;
    for (const params::Parameter& p : d->parameters) {
      EXPECT_FALSE(p.help.empty()) << d->name << "." << p.name;
      if (p.name != "type") {
        EXPECT_NE(page.find("| `" + p.name + "` |"), std::string::npos) << p.name;
      }
    }
  }
}

// Enough of draft 7 for what schema_of uses.
bool accepts(const json& schema, const json& value, const json& definitions) {
  if (schema.contains("$ref")) {
    const std::string name = schema["$ref"].get<std::string>().substr(14);  // "#/definitions/"
    return accepts(definitions.at(name), value, definitions);
  }
  for (const json& part : schema.value("allOf", json::array()))
    if (!accepts(part, value, definitions)) return false;
  if (schema.contains("oneOf")) {
    int matches = 0;
    for (const json& part : schema["oneOf"]) matches += accepts(part, value, definitions);
    return matches == 1;
  }
  if (schema.contains("const") && schema["const"] != value) return false;
  if (schema.contains("enum") &&
      std::find(schema["enum"].begin(), schema["enum"].end(), value) == schema["enum"].end())
    return false;
  if (schema.contains("type")) {
    const auto is = [&](const json& type) {
      if (type == "object") return value.is_object();
      if (type == "array") return value.is_array();
      if (type == "string") return value.is_string();
      if (type == "boolean") return value.is_boolean();
      if (type == "integer") return value.is_number_integer();
      return value.is_number();
    };
    const json& type = schema["type"];
    bool any = false;
    for (const json& t : type.is_array() ? type : json::array({type})) any = any || is(t);
    if (!any) return false;
  }
  if (value.is_number()) {
    const double x = value.get<double>();
    if (schema.contains("minimum") && x < schema["minimum"].get<double>()) return false;
    if (schema.contains("exclusiveMinimum") && x <= schema["exclusiveMinimum"].get<double>())
      return false;
    if (schema.contains("maximum") && x > schema["maximum"].get<double>()) return false;
  }
  if (value.is_array()) {
    if (schema.contains("minItems") && value.size() < schema["minItems"].get<std::size_t>())
      return false;
    if (schema.contains("maxItems") && value.size() > schema["maxItems"].get<std::size_t>())
      return false;
    for (const json& item : value)
      if (schema.contains("items") && !accepts(schema["items"], item, definitions)) return false;
  }
  if (value.is_object()) {
    for (const json& name : schema.value("required", json::array()))
      if (!value.contains(name.get<std::string>())) return false;
    const json properties = schema.value("properties", json::object());
    for (const auto& [name, item] : value.items()) {
      if (!properties.contains(name)) {
        if (schema.value("additionalProperties", true) == false) return false;
      } else if (!accepts(properties[name], item, definitions)) {
        return false;
      }
    }
  }
  return true;
}

TEST(FieldReference, TheSchemaAcceptsAndRefuses) {
  const json schema = hypertexture_schema();
  const json good{
      {"name", "rock"},
      {"type", "hypertexture"},
      {"bounds", {{"min", {-1, -1, -1}}, {"max", {1, 1, 1}}}},
      {"field",
       {{"density",
         {{"type", "union"},
          {"densities",
           {{{"type", "sphere"}, {"radius", 2}},
            {{"type", "metaballs"}, {"balls", {{{"radius", 0.5}}}}}}}}},
        {"modulations",
         {{{"type", "fbm"}, {"noise", "perlin"}, {"mask", {{"type", "height"}, {"axis", "y"}}}},
          {{"type", "bias"}, {"bias", 0.3}}}}}}};
  EXPECT_TRUE(accepts(schema, good, schema["definitions"]));
  const auto refuses = [&](const char* pointer, const json& value) {
    json bad = good;
    bad[json::json_pointer(pointer)] = value;
    EXPECT_FALSE(accepts(schema, bad, schema["definitions"])) << pointer << " " << value;
  };
  refuses("/field/density/densities/0/radius", 0);
  refuses("/field/density/densities/0/radii", 1);
  refuses("/field/density/densities/0/type", "spere");
  refuses("/field/density/densities/1/balls/0/radius", "big");
  refuses("/field/density/densities/1/balls", json::array());
  refuses("/field/modulations/0/noise", "simplex");
  refuses("/field/modulations/0/mask/axis", "w");
  refuses("/field/modulations/1/bias", 1.5);
  refuses("/bounds/min", {0, 0});
  refuses("/max_depth", 99);
}

}  // namespace
}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/declarations.h"
#include "renderer/scene/reader_tools.h"
#include "renderer/scene/readers.h"

namespace morsel::render {
namespace {

using params::JsonReader;
using params::Place;

float number(const JsonReader& reader, const char* name) {
  return static_cast<float>(reader.number(name));
}

void read_diffuse(const JsonReader& reader, Material& m) {
  m.type = MaterialType::kDiffuse;
  m.diffuse_roughness = number(reader, "diffuse_roughness");
  if (reader.has("checker_color")) m.checker_color = to_float(reader.vector3("checker_color"));
  m.checker_size = number(reader, "checker_size");
}

void read_attenuation(const JsonReader& reader, Material& m) {
  m.ior = number(reader, "ior");
  m.attenuation_distance = number(reader, "attenuation_distance");
  m.attenuation_color = to_float(reader.vector3("attenuation_color"));
}

void read_principled(const JsonReader& reader, Material& m) {
  m.type = MaterialType::kPrincipled;
  read_attenuation(reader, m);
  m.diffuse_roughness = number(reader, "diffuse_roughness");
  m.metallic = number(reader, "metallic");
  m.specular = number(reader, "specular");
  m.specular_color = to_float(reader.vector3("specular_color"));
  m.transmission = number(reader, "transmission");
  m.thin = reader.boolean("thin");
  m.clearcoat = number(reader, "clearcoat");
  m.clearcoat_roughness = number(reader, "clearcoat_roughness");
  m.sheen_color = to_float(reader.vector3("sheen_color"));
  m.sheen_roughness = number(reader, "sheen_roughness");
  m.emission = to_float(reader.vector3("emission"));
  m.opacity = number(reader, "opacity");
  m.opacity_cutoff = number(reader, "opacity_cutoff");
  m.normal_scale = number(reader, "normal_scale");
  m.bump_height = number(reader, "bump_height");
}

const params::Declaration& declaration_of(const std::string& type) {
  if (type == "diffuse") return diffuse_declaration();
  if (type == "conductor") return conductor_declaration();
  if (type == "dielectric") return dielectric_declaration();
  return principled_declaration();
}

}  // namespace

Material read_material(const nlohmann::json& object, const Place& place, Scene& scene) {
  const std::string type =
      params::type_of(object, {"diffuse", "conductor", "dielectric", "principled"}, place);
  const JsonReader reader(object, declaration_of(type), place);
  Material material;
  material.name = reader.string("name");
  material.color = to_float(reader.vector3("color"));
  if (type == "diffuse") {
    read_diffuse(reader, material);
    read_material_textures(reader, {MaterialInput::kColor}, scene, material);
    return material;
  }
  material.roughness = number(reader, "roughness");
  if (type == "conductor") {
    material.type = MaterialType::kConductor;
  } else if (type == "dielectric") {
    material.type = MaterialType::kDielectric;
    read_attenuation(reader, material);
  } else {
    read_principled(reader, material);
    read_material_textures(
        reader,
        {MaterialInput::kColor, MaterialInput::kRoughness, MaterialInput::kMetallic,
         MaterialInput::kSpecular, MaterialInput::kSpecularColor, MaterialInput::kTransmission,
         MaterialInput::kClearcoat, MaterialInput::kClearcoatRoughness, MaterialInput::kSheenColor,
         MaterialInput::kSheenRoughness, MaterialInput::kEmission, MaterialInput::kOpacity,
         MaterialInput::kNormal, MaterialInput::kBump},
        scene, material);
    material.group = light_group(reader, scene.light_groups);
  }
  return material;
}

}  // namespace morsel::render

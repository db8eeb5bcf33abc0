// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/common_parameters.h"
#include "renderer/scene/declarations.h"

namespace morsel::render {
namespace {

using params::Declaration;
using params::Parameter;
using params::Type;

Parameter roughness_parameter(const char* name, double default_value) {
  return share_parameter(
      name, default_value,
      "perceptual roughness; the GGX width is its square, 0 is perfectly smooth");
}

Parameter diffuse_roughness_parameter() {
  return share_parameter(
      "diffuse_roughness", 0.0,
      "grooves of the matte body: 0 is Lambert's law, 1 looks like clay or dust");
}

Parameter attenuation_distance_parameter() {
  return {.name = "attenuation_distance",
          .default_value = 0.0,
          .help =
              "way through the inside on which white light becomes attenuation_color; 0: nothing "
              "is absorbed inside and the colour tints what passes",
          .unit = "length",
          .min = 0.0,
          .max = 1e9};
}

Parameter attenuation_color_parameter() {
  return tint_parameter("attenuation_color", {1.0, 1.0, 1.0},
                        "colour of white light after attenuation_distance");
}

Parameter texture_parameter(const char* name, const char* help) {
  return {.name = name, .type = Type::kString, .help = help, .optional = true};
}

}  // namespace

const Declaration& diffuse_declaration() {
  static const Declaration declaration{
      "diffuse material",
      "A Lambertian reflector",
      {type_parameter("diffuse", true),
       name_parameter("name of the material"),
       tint_parameter("color", {0.5, 0.5, 0.5}, "albedo"),
       texture_parameter("color_texture", "multiplies the colour"),
       diffuse_roughness_parameter(),
       {.name = "checker_color",
        .type = Type::kColor,
        .help = "albedo of every other square of a checkerboard in world x and z",
        .min = 0.0,
        .max = 1.0,
        .optional = true},
       {.name = "checker_size",
        .default_value = 1.0,
        .help = "side of a square of the checkerboard",
        .unit = "length",
        .min = 0.0,
        .exclusive_min = true}}};
  return declaration;
}

const Declaration& conductor_declaration() {
  static const Declaration declaration{
      "conductor material",
      "A metal with a GGX microfacet surface",
      {type_parameter("conductor", true), name_parameter("name of the material"),
       tint_parameter("color", {0.9, 0.9, 0.9}, "reflectance at normal incidence"),
       roughness_parameter("roughness", 0.2)}};
  return declaration;
}

const Declaration& dielectric_declaration() {
  static const Declaration declaration{
      "dielectric material",
      "Glass or another clear solid with a GGX microfacet surface",
      {type_parameter("dielectric", true),
       name_parameter("name of the material"),
       tint_parameter("color", {1.0, 1.0, 1.0}, "tint of transmitted light"),
       roughness_parameter("roughness", 0.0),
       {.name = "ior",
        .default_value = 1.5,
        .help = "index of refraction of the inside relative to the outside",
        .min = 1.0,
        .max = 10.0},
       attenuation_distance_parameter(),
       attenuation_color_parameter()}};
  return declaration;
}

const Declaration& principled_declaration() {
  static const Declaration declaration{
      "principled material",
      "glTF 2.0's metallic-roughness material with clear coat, sheen, transmission, specular tint, "
      "volume, emission and opacity",
      {type_parameter("principled", true),
       name_parameter("name of the material"),
       tint_parameter("color", {0.8, 0.8, 0.8},
                      "albedo, reflectance of metal, tint of what passes through"),
       share_parameter("metallic", 0.0, "0: dielectric, 1: metal"),
       roughness_parameter("roughness", 0.5),
       diffuse_roughness_parameter(),
       {.name = "ior",
        .default_value = 1.5,
        .help = "index of refraction of the inside relative to the outside",
        .min = 1.0,
        .max = 10.0},
       share_parameter("specular", 1.0, "scales the reflection of what is not metal"),
       tint_parameter("specular_color", {1.0, 1.0, 1.0},
                      "tints that reflection at normal incidence"),
       share_parameter("transmission", 0.0, "share of the body that is clear instead of matte"),
       flag_parameter("thin", false, "a sheet without an inside: light passes unbent"),
       attenuation_distance_parameter(),
       attenuation_color_parameter(),
       share_parameter("clearcoat", 0.0, "strength of a clear coat of index 1.5"),
       roughness_parameter("clearcoat_roughness", 0.0),
       tint_parameter("sheen_color", {0.0, 0.0, 0.0}, "reflection of cloth fibres; black: none"),
       roughness_parameter("sheen_roughness", 0.3),
       {.name = "emission",
        .type = Type::kNumberOrVector3,
        .default_value = 0.0,
        .help = "emitted radiance, on both sides; meshes that emit are sampled as lights",
        .unit = "radiance",
        .min = 0.0,
        .max = 1e9},
       share_parameter("opacity", 1.0, "share of light that meets the surface at all"),
       share_parameter("opacity_cutoff", 0.0,
                       "above 0: the surface is there where the opacity reaches this, else not"),
       {.name = "normal_scale",
        .default_value = 1.0,
        .help = "how much the normal map leans",
        .min = -10.0,
        .max = 10.0},
       {.name = "bump_height",
        .default_value = 0.1,
        .help = "height of a bump texture's 1",
        .unit = "length",
        .min = -1e6,
        .max = 1e6},
       texture_parameter("color_texture", "multiplies the colour"),
       texture_parameter("roughness_texture", "multiplies the roughness"),
       texture_parameter("metallic_texture", "multiplies metallic"),
       texture_parameter("specular_texture", "multiplies specular"),
       texture_parameter("specular_color_texture", "multiplies the specular colour"),
       texture_parameter("transmission_texture", "multiplies the transmission"),
       texture_parameter("clearcoat_texture", "multiplies the clear coat"),
       texture_parameter("clearcoat_roughness_texture", "multiplies its roughness"),
       texture_parameter("sheen_color_texture", "multiplies the sheen's colour"),
       texture_parameter("sheen_roughness_texture", "multiplies its roughness"),
       texture_parameter("emission_texture", "multiplies the emission"),
       texture_parameter("opacity_texture", "multiplies the opacity"),
       texture_parameter("normal_texture", "normal map in tangent space, y up"),
       texture_parameter("bump_texture", "height of the surface, in units of bump_height"),
       {.name = "group",
        .type = Type::kString,
        .default_value = "",
        .help = "light group of what it emits"}}};
  return declaration;
}

}  // namespace morsel::render

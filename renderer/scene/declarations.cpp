// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/declarations.h"

#include <limits>

namespace morsel::render {
namespace {

using nlohmann::json;
using params::Declaration;
using params::Parameter;
using params::Type;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Parameter type_parameter(const char* type, bool required) {
  return {.name = "type",
          .type = Type::kChoice,
          .default_value = required ? json(nullptr) : json(type),
          .help = "kind",
          .choices = {type}};
}

Parameter name_parameter(const char* help) {
  return {.name = "name", .type = Type::kString, .help = help};
}

Parameter color_parameter(json default_value, const char* help) {
  return {.name = "color",
          .type = Type::kColor,
          .default_value = std::move(default_value),
          .help = help,
          .min = 0.0,
          .max = 1.0};
}

Parameter roughness_parameter(double default_value) {
  return {.name = "roughness",
          .default_value = default_value,
          .help = "perceptual roughness; the GGX width is its square, 0 is perfectly smooth",
          .min = 0.0,
          .max = 1.0};
}

Parameter visible_parameter() {
  return {.name = "visible_to_camera",
          .type = Type::kBoolean,
          .default_value = true,
          .help = "whether camera rays see the light itself"};
}

Parameter radiance_parameter(const char* help) {
  return {.name = "radiance",
          .type = Type::kNumberOrVector3,
          .default_value = 1.0,
          .help = help,
          .min = 0.0,
          .max = 1e9};
}

}  // namespace

const Declaration& scene_declaration() {
  static const Declaration declaration{
      "scene",
      "A scene file",
      {{.name = "morsel",
        .type = Type::kInteger,
        .help = "version of the scene format",
        .min = 1,
        .max = 1},
       {.name = "description",
        .type = Type::kString,
        .help = "what the scene shows; for people",
        .optional = true},
       {.name = "camera", .type = Type::kObject, .help = "the camera", .optional = true},
       {.name = "render", .type = Type::kObject, .help = "image and sampling", .optional = true},
       {.name = "materials",
        .type = Type::kArray,
        .default_value = json::array(),
        .help = "materials, named by instances"},
       {.name = "geometries",
        .type = Type::kArray,
        .default_value = json::array(),
        .help = "shapes in object space, named by instances"},
       {.name = "instances",
        .type = Type::kArray,
        .default_value = json::array(),
        .help = "placed geometries with their materials"},
       {.name = "lights",
        .type = Type::kArray,
        .default_value = json::array(),
        .help = "lights in world space"}}};
  return declaration;
}

const Declaration& camera_declaration() {
  static const Declaration declaration{
      "camera",
      "A perspective camera",
      {type_parameter("perspective", false),
       {.name = "position",
        .type = Type::kVector3,
        .default_value = {0.0, 0.0, 5.0},
        .help = "centre of projection",
        .unit = "length"},
       {.name = "look_at",
        .type = Type::kVector3,
        .default_value = {0.0, 0.0, 0.0},
        .help = "point that projects to the middle of the image",
        .unit = "length"},
       {.name = "up",
        .type = Type::kVector3,
        .default_value = {0.0, 1.0, 0.0},
        .help = "direction that is up in the image"},
       {.name = "vertical_fov",
        .default_value = 40.0,
        .help = "angle between the lower and the upper edge of the image",
        .unit = "degrees",
        .min = 0.0,
        .max = 179.0,
        .exclusive_min = true}}};
  return declaration;
}

const Declaration& render_declaration() {
  static const Declaration declaration{
      "render",
      "Image and sampling",
      {{.name = "resolution",
        .type = Type::kVector2,
        .default_value = {960, 540},
        .help = "width and height",
        .unit = "pixels",
        .min = 1,
        .max = 65536},
       {.name = "spp",
        .type = Type::kInteger,
        .default_value = 64,
        .help = "samples a pixel",
        .min = 1,
        .max = 1 << 20},
       {.name = "max_depth",
        .type = Type::kInteger,
        .default_value = 8,
        .help = "path vertices beyond the first hit",
        .min = 0,
        .max = 1024},
       {.name = "seed",
        .type = Type::kInteger,
        .default_value = 0,
        .help = "seed of the sample sequence",
        .min = 0,
        .max = 4294967295.0},
       {.name = "exposure",
        .default_value = 0.0,
        .help = "exposure of the PNG preview; the EXR is unchanged",
        .unit = "stops",
        .min = -40.0,
        .max = 40.0},
       {.name = "regularization",
        .default_value = 0.0,
        .help = "blurs caustics: what is seen by way of a rougher surface is taken to be at least "
                "this share as rough; 0 is exact and the default",
        .min = 0.0,
        .max = 1.0}}};
  return declaration;
}

const Declaration& diffuse_declaration() {
  static const Declaration declaration{
      "diffuse material",
      "A Lambertian reflector",
      {type_parameter("diffuse", true),
       name_parameter("name of the material"),
       color_parameter({0.5, 0.5, 0.5}, "albedo"),
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
       color_parameter({0.9, 0.9, 0.9}, "reflectance at normal incidence"),
       roughness_parameter(0.2)}};
  return declaration;
}

const Declaration& dielectric_declaration() {
  static const Declaration declaration{
      "dielectric material",
      "Glass or another clear solid with a GGX microfacet surface",
      {type_parameter("dielectric", true),
       name_parameter("name of the material"),
       color_parameter({1.0, 1.0, 1.0}, "tint of transmitted light"),
       roughness_parameter(0.0),
       {.name = "ior",
        .default_value = 1.5,
        .help = "index of refraction of the inside relative to the outside",
        .min = 1.0,
        .max = 10.0}}};
  return declaration;
}

const Declaration& mesh_declaration() {
  static const Declaration declaration{
      "mesh geometry",
      "Triangles from a file",
      {type_parameter("mesh", true),
       name_parameter("name of the geometry"),
       {.name = "file",
        .type = Type::kString,
        .help = "an .obj, .ply, .stl, .gltf or .glb file, relative to the scene file"},
       {.name = "smooth",
        .type = Type::kBoolean,
        .default_value = true,
        .help = "make smooth vertex normals when the file has none; otherwise facets show"}}};
  return declaration;
}

const Declaration& rectangle_declaration() {
  static const Declaration declaration{
      "rectangle geometry",
      "A rectangle in the plane y = 0, centred on the origin, facing +y",
      {type_parameter("rectangle", true),
       name_parameter("name of the geometry"),
       {.name = "size",
        .type = Type::kVector2,
        .default_value = {1.0, 1.0},
        .help = "extent along x and along z",
        .unit = "length",
        .min = 0.0,
        .max = kInfinity,
        .exclusive_min = true}}};
  return declaration;
}

const Declaration& sphere_declaration() {
  static const Declaration declaration{"sphere geometry",
                                       "A tessellated sphere about the origin with exact normals",
                                       {type_parameter("sphere", true),
                                        name_parameter("name of the geometry"),
                                        {.name = "radius",
                                         .default_value = 1.0,
                                         .help = "distance of the vertices from the origin",
                                         .unit = "length",
                                         .min = 0.0,
                                         .exclusive_min = true},
                                        {.name = "segments",
                                         .type = Type::kInteger,
                                         .default_value = 64,
                                         .help = "edges around the equator",
                                         .min = 4,
                                         .max = 4096}}};
  return declaration;
}

const Declaration& instance_declaration() {
  static const Declaration declaration{
      "instance",
      "A geometry placed in the world: scaled, then rotated about x, y and z, then translated",
      {{.name = "name",
        .type = Type::kString,
        .default_value = "",
        .help = "name of the instance; that of the geometry if absent"},
       {.name = "geometry", .type = Type::kString, .help = "name of a geometry"},
       {.name = "material", .type = Type::kString, .help = "name of a material"},
       {.name = "detached_material",
        .type = Type::kString,
        .help = "hypertexture: material of the pieces that are not the main one",
        .optional = true},
       {.name = "translate",
        .type = Type::kVector3,
        .default_value = {0.0, 0.0, 0.0},
        .help = "applied last",
        .unit = "length"},
       {.name = "rotate",
        .type = Type::kVector3,
        .default_value = {0.0, 0.0, 0.0},
        .help = "about the x axis, then the world's y axis, then the world's z axis",
        .unit = "degrees"},
       {.name = "scale",
        .type = Type::kNumberOrVector3,
        .default_value = 1.0,
        .help = "applied first"},
       {.name = "transform",
        .type = Type::kArray,
        .help = "instead of the three: 4 rows of 4 numbers that multiply column vectors, so the "
                "last column is the translation and the last row is 0 0 0 1",
        .optional = true}}};
  return declaration;
}

const Declaration& environment_light_declaration() {
  static const Declaration declaration{
      "environment light",
      "Light from infinitely far away, constant or from a latitude-longitude image",
      {type_parameter("environment", true),
       {.name = "name", .type = Type::kString, .default_value = "", .help = "name of the light"},
       {.name = "file",
        .type = Type::kString,
        .default_value = "",
        .help = "image, relative to the scene file; without one the light is constant"},
       radiance_parameter("multiplies the image, or the radiance itself"),
       {.name = "rotation",
        .default_value = 0.0,
        .help = "rotation of the image about +y",
        .unit = "degrees"},
       visible_parameter()}};
  return declaration;
}

const Declaration& rectangle_light_declaration() {
  static const Declaration declaration{
      "rectangle light",
      "A one-sided rectangle, given by a corner and two edges (it emits to the side that edge_u x "
      "edge_v points to), or by its centre, its size and the point that it faces",
      {type_parameter("rectangle", true),
       {.name = "name", .type = Type::kString, .default_value = "", .help = "name of the light"},
       {.name = "corner",
        .type = Type::kVector3,
        .help = "a corner",
        .unit = "length",
        .optional = true},
       {.name = "edge_u",
        .type = Type::kVector3,
        .help = "from the corner along one side",
        .unit = "length",
        .optional = true},
       {.name = "edge_v",
        .type = Type::kVector3,
        .help = "from the corner along the other side",
        .unit = "length",
        .optional = true},
       {.name = "position",
        .type = Type::kVector3,
        .help = "the centre",
        .unit = "length",
        .optional = true},
       {.name = "look_at",
        .type = Type::kVector3,
        .help = "point that the light faces",
        .unit = "length",
        .optional = true},
       {.name = "size",
        .type = Type::kVector2,
        .help = "width and height",
        .unit = "length",
        .min = 0.0,
        .exclusive_min = true,
        .optional = true},
       radiance_parameter("emitted radiance"),
       visible_parameter()}};
  return declaration;
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/declarations.h"

#include "renderer/scene/common_parameters.h"

#include <limits>

namespace morsel::render {
namespace {

using nlohmann::json;
using params::Declaration;
using params::Type;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

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
       {.name = "$schema",
        .type = Type::kString,
        .help = "where editors find the schema that `morsel scene schema` prints; of no meaning "
                "here",
        .optional = true},
       {.name = "description",
        .type = Type::kString,
        .help = "what the scene shows; for people",
        .optional = true},
       {.name = "camera",
        .type = Type::kObject,
        .help = "the camera",
        .optional = true,
        .record = &camera_declaration()},
       {.name = "render",
        .type = Type::kObject,
        .help = "image and sampling",
        .optional = true,
        .record = &render_declaration()},
       {.name = "textures",
        .type = Type::kArray,
        .default_value = json::array(),
        .help = "images, ramps and checkers, named by materials",
        .kind = "texture"},
       {.name = "models",
        .type = Type::kArray,
        .default_value = json::array(),
        .help = "files that bring their own materials, instances, lights and camera",
        .record = &model_declaration()},
       {.name = "materials",
        .type = Type::kArray,
        .default_value = json::array(),
        .help = "materials, named by instances",
        .kind = "material"},
       {.name = "geometries",
        .type = Type::kArray,
        .default_value = json::array(),
        .help = "shapes in object space, named by instances",
        .kind = "geometry"},
       {.name = "instances",
        .type = Type::kArray,
        .default_value = json::array(),
        .help = "placed geometries with their materials",
        .record = &instance_declaration()},
       {.name = "lights",
        .type = Type::kArray,
        .default_value = json::array(),
        .help = "lights in world space",
        .kind = "light"}}};
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

}  // namespace morsel::render

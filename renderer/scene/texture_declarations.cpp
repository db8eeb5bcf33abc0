// SPDX-License-Identifier: Apache-2.0
// Textures, and models that bring them.
#include "renderer/scene/common_parameters.h"
#include "renderer/scene/declarations.h"

namespace morsel::render {
namespace {

using params::Declaration;
using params::Parameter;
using params::Type;

Parameter positive_length(const char* name, const char* help) {
  return {.name = name,
          .default_value = 1.0,
          .help = help,
          .unit = "length",
          .min = 0.0,
          .exclusive_min = true};
}

Parameter wrap_parameter(const char* name, const char* help) {
  return {.name = name,
          .type = Type::kChoice,
          .default_value = "repeat",
          .help = help,
          .choices = {"repeat", "clamp", "mirror", "black"}};
}

}  // namespace

const Declaration& image_texture_declaration() {
  static const Declaration declaration{
      "image texture",
      "An image by the mesh's texture coordinates, or projected along the three axes",
      {type_parameter("image", true),
       name_parameter("name of the texture"),
       {.name = "file",
        .type = Type::kString,
        .help = "image, relative to the scene file; <UDIM> in it stands for the numbers of tiles"},
       {.name = "color_space",
        .type = Type::kChoice,
        .default_value = "auto",
        .help = "how colours are stored; auto: sRGB if an image of 8 bits is used as a colour",
        .choices = {"auto", "srgb", "linear"}},
       {.name = "channel",
        .type = Type::kChoice,
        .default_value = "luminance",
        .help = "what is taken where a number is wanted",
        .choices = {"red", "green", "blue", "alpha", "luminance"}},
       {.name = "mapping",
        .type = Type::kChoice,
        .default_value = "uv",
        .help = "uv: by texture coordinates; triplanar: projected along the object's axes",
        .choices = {"uv", "triplanar"}},
       {.name = "uv_set",
        .type = Type::kInteger,
        .default_value = 0,
        .help = "uv: which of the mesh's texture coordinates; the first stand in for the second",
        .min = 0,
        .max = 1},
       positive_length("size", "triplanar: what one repetition covers in object space"),
       {.name = "scale",
        .type = Type::kVector2,
        .default_value = {1.0, 1.0},
        .help = "multiplies the texture coordinates, first",
        .min = -params::kFarthest,
        .max = params::kFarthest},
       {.name = "rotation",
        .default_value = 0.0,
        .help = "turns them counter-clockwise about (0, 0), second",
        .unit = "degrees"},
       {.name = "offset",
        .type = Type::kVector2,
        .default_value = {0.0, 0.0},
        .help = "is added to them, last"},
       wrap_parameter("wrap_u", "beyond the left and right edges"),
       wrap_parameter("wrap_v", "beyond the upper and lower edges")}};
  return declaration;
}

const Declaration& ramp_texture_declaration() {
  static const Declaration declaration{
      "ramp texture",
      "A colour by a number that points of a solid have; no image and no texture coordinates",
      {type_parameter("ramp", true),
       name_parameter("name of the texture"),
       {.name = "input",
        .type = Type::kChoice,
        .default_value = "noise",
        .help =
            "of hypertexture: the density D, the noise (F - D), the mean curvature of the surface "
            "(1/length, positive where it bulges), the component (its share of all); of anything: "
            "the height, object-space y",
        .choices = {"density", "noise", "curvature", "component", "height"}},
       {.name = "low", .default_value = 0.0, .help = "value that becomes position 0"},
       {.name = "high", .default_value = 1.0, .help = "value that becomes position 1"},
       {.name = "stops",
        .type = Type::kArray,
        .help = "colours by growing position: [[0, [r, g, b]], [1, [r, g, b]]]; linear in between",
        .min = 1}}};
  return declaration;
}

const Declaration& checker_texture_declaration() {
  static const Declaration declaration{
      "checker texture",
      "Cubes of two colours in object space, or squares in texture coordinates",
      {type_parameter("checker", true),
       name_parameter("name of the texture"),
       tint_parameter("color_a", {0.8, 0.8, 0.8}, "one colour"),
       tint_parameter("color_b", {0.2, 0.2, 0.2}, "the other"),
       positive_length("size", "side of a cube or square"),
       {.name = "mapping",
        .type = Type::kChoice,
        .default_value = "solid",
        .help = "solid: object space; uv: texture coordinates",
        .choices = {"solid", "uv"}}}};
  return declaration;
}

const Declaration& model_declaration() {
  static const Declaration declaration{
      "model",
      "A glTF or OBJ file with its own materials, textures, nodes, lights and camera, placed like "
      "an "
      "instance",
      {{.name = "name",
        .type = Type::kString,
        .default_value = "",
        .help = "goes before the names of what it brings; that of the file if absent"},
       {.name = "file",
        .type = Type::kString,
        .help = "a .gltf, .glb or .obj file, relative to the scene file"},
       flag_parameter("lights", true, "take the file's lights"),
       flag_parameter("camera", true, "take the file's first camera if the scene has none"),
       {.name = "translate",
        .type = Type::kVector3,
        .default_value = {0.0, 0.0, 0.0},
        .help = "applied last",
        .unit = "length",
        .min = -params::kFarthest,
        .max = params::kFarthest},
       {.name = "rotate",
        .type = Type::kVector3,
        .default_value = {0.0, 0.0, 0.0},
        .help = "about the x axis, then the world's y axis, then the world's z axis",
        .unit = "degrees",
        .min = -params::kFarthest,
        .max = params::kFarthest},
       {.name = "scale",
        .type = Type::kNumberOrVector3,
        .default_value = 1.0,
        .help = "applied first",
        .min = -params::kFarthest,
        .max = params::kFarthest}}};
  return declaration;
}

}  // namespace morsel::render

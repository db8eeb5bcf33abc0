// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/common_parameters.h"
#include "renderer/scene/declarations.h"

namespace morsel::render {

using params::Declaration;
using params::Type;

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
       {.name = "visible_to_camera",
        .type = Type::kBoolean,
        .default_value = true,
        .help = "whether camera rays see it"},
       {.name = "visible_to_bounces",
        .type = Type::kBoolean,
        .default_value = true,
        .help = "whether reflections, refractions and indirect light see it; what emits and is "
                "hidden from them lights nothing"},
       {.name = "casts_shadow",
        .type = Type::kBoolean,
        .default_value = true,
        .help = "whether it blocks the light of lights"},
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
        .max = params::kFarthest},
       {.name = "translate_end",
        .type = Type::kVector3,
        .help = "where it has moved to at the end of the frame",
        .unit = "length",
        .min = -params::kFarthest,
        .max = params::kFarthest,
        .optional = true},
       {.name = "rotate_end",
        .type = Type::kVector3,
        .help = "rotation at the end of the frame; the way there is straight, so keep it small",
        .unit = "degrees",
        .min = -params::kFarthest,
        .max = params::kFarthest,
        .optional = true},
       {.name = "scale_end",
        .type = Type::kNumberOrVector3,
        .help = "scale at the end of the frame",
        .min = -params::kFarthest,
        .max = params::kFarthest,
        .optional = true},
       {.name = "transform",
        .type = Type::kMatrix4,
        .help = "instead of the three: 4 rows of 4 numbers that multiply column vectors, so the "
                "last column is the translation and the last row is 0 0 0 1",
        .min = -params::kFarthest,
        .max = params::kFarthest,
        .optional = true}}};
  return declaration;
}

}  // namespace morsel::render

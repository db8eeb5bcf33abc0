// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/common_parameters.h"
#include "renderer/scene/declarations.h"

namespace morsel::render {
namespace {

using params::Declaration;
using params::Parameter;
using params::Type;

Parameter visible_parameter() {
  return flag_parameter("visible_to_camera", true, "whether camera rays see the light itself");
}
Parameter shadow_parameter() {
  return flag_parameter("casts_shadow", true, "whether the light's surface blocks other light");
}
Parameter group_parameter() {
  return {.name = "group",
          .type = Type::kString,
          .default_value = "",
          .help = "light group: the light of each group gets an image layer of its own"};
}
Parameter angle_parameter(const char* name, double default_value, double min, double max,
                          const char* help) {
  return {.name = name,
          .default_value = default_value,
          .help = help,
          .unit = "degrees",
          .min = min,
          .max = max};
}
Parameter radius_parameter(const char* help) {
  return {.name = "radius",
          .default_value = 1.0,
          .help = help,
          .unit = "length",
          .min = 0.0,
          .exclusive_min = true};
}

}  // namespace

const Declaration& environment_light_declaration() {
  static const Declaration declaration{
      "environment light",
      "Light from infinitely far away, constant or from a latitude-longitude image",
      {type_parameter("environment", true),
       optional_name_parameter("name of the light"),
       {.name = "file",
        .type = Type::kString,
        .default_value = "",
        .help = "image, relative to the scene file; without one the light is constant"},
       radiance_parameter("radiance", "multiplies the image, or the radiance itself"),
       {.name = "rotation",
        .default_value = 0.0,
        .help = "rotation of the image about +y",
        .unit = "degrees"},
       visible_parameter(),
       group_parameter()}};
  return declaration;
}

const Declaration& rectangle_light_declaration() {
  static const Declaration declaration{
      "rectangle light",
      "A one-sided rectangle, given by a corner and two edges (it emits to the side that edge_u x "
      "edge_v points to), or by its centre, its size and the point that it faces",
      {type_parameter("rectangle", true),
       optional_name_parameter("name of the light"),
       {.name = "corner",
        .type = Type::kVector3,
        .help = "a corner",
        .unit = "length",
        .min = -params::kFarthest,
        .max = params::kFarthest,
        .optional = true},
       {.name = "edge_u",
        .type = Type::kVector3,
        .help = "from the corner along one side",
        .unit = "length",
        .min = -params::kFarthest,
        .max = params::kFarthest,
        .optional = true},
       {.name = "edge_v",
        .type = Type::kVector3,
        .help = "from the corner along the other side",
        .unit = "length",
        .min = -params::kFarthest,
        .max = params::kFarthest,
        .optional = true},
       {.name = "position",
        .type = Type::kVector3,
        .help = "the centre",
        .unit = "length",
        .min = -params::kFarthest,
        .max = params::kFarthest,
        .optional = true},
       {.name = "look_at",
        .type = Type::kVector3,
        .help = "point that the light faces",
        .unit = "length",
        .min = -params::kFarthest,
        .max = params::kFarthest,
        .optional = true},
       {.name = "size",
        .type = Type::kVector2,
        .help = "width and height",
        .unit = "length",
        .min = 0.0,
        .exclusive_min = true,
        .optional = true},
       radiance_parameter("radiance", "emitted radiance"),
       visible_parameter(),
       shadow_parameter(),
       group_parameter()}};
  return declaration;
}

const Declaration& sky_light_declaration() {
  static const Declaration declaration{
      "sky light",
      "The clear sky of a day with its sun (Preetham's model), and the ground below; radiance 1 "
      "stands for 10 kcd/m^2",
      {type_parameter("sky", true),
       optional_name_parameter("name of the light"),
       angle_parameter("sun_elevation", 40.0, -90.0, 90.0,
                       "height of the sun above the horizon; below it the sun is gone, and the sky "
                       "that of a sun on the horizon"),
       angle_parameter("sun_azimuth", 0.0, -360.0, 360.0, "where the sun is: 0 is -z, 90 is +x"),
       angle_parameter("sun_diameter", 0.53, 0.0, 90.0, "angular diameter of the sun"),
       {.name = "turbidity",
        .default_value = 3.0,
        .help = "haze: 2 is very clear, 10 hazy",
        .min = 1.7,
        .max = 10.0},
       tint_parameter("ground_color", {0.2, 0.2, 0.2}, "albedo of the ground below the horizon"),
       radiance_parameter("radiance", "multiplies sky and sun"),
       visible_parameter(),
       group_parameter()}};
  return declaration;
}

const Declaration& disk_light_declaration() {
  static const Declaration declaration{
      "disk light",
      "A disk that shines to the side of the point that it faces",
      {type_parameter("disk", true), optional_name_parameter("name of the light"),
       point_parameter("position", "the centre"),
       point_parameter("look_at", "point that the light faces"), radius_parameter("its radius"),
       radiance_parameter("radiance", "emitted radiance"), visible_parameter(), shadow_parameter(),
       group_parameter()}};
  return declaration;
}

const Declaration& sphere_light_declaration() {
  static const Declaration declaration{
      "sphere light",
      "A sphere that shines outwards",
      {type_parameter("sphere", true), optional_name_parameter("name of the light"),
       point_parameter("position", "the centre"), radius_parameter("its radius"),
       radiance_parameter("radiance", "emitted radiance"), visible_parameter(), shadow_parameter(),
       group_parameter()}};
  return declaration;
}

const Declaration& point_light_declaration() {
  static const Declaration declaration{
      "point light",
      "A point that shines in all directions, or a spot",
      {type_parameter("point", true),
       optional_name_parameter("name of the light"),
       point_parameter("position", "where it is"),
       {.name = "look_at",
        .type = Type::kVector3,
        .help = "spot: point that it faces",
        .unit = "length",
        .min = -params::kFarthest,
        .max = params::kFarthest,
        .optional = true},
       angle_parameter("inner_angle", 0.0, 0.0, 180.0,
                       "spot: up to this angle from the axis the light is full"),
       angle_parameter("outer_angle", 180.0, 0.0, 180.0,
                       "spot: from this angle on there is none; 180: shines everywhere"),
       radiance_parameter("intensity", "radiant intensity, flux per steradian"),
       group_parameter()}};
  return declaration;
}

const Declaration& distant_light_declaration() {
  static const Declaration declaration{
      "distant light",
      "Light from one direction, like the sun's",
      {type_parameter("distant", true),
       optional_name_parameter("name of the light"),
       {.name = "direction",
        .type = Type::kVector3,
        .default_value = {0.0, -1.0, 0.0},
        .help = "that the light travels in",
        .min = -params::kFarthest,
        .max = params::kFarthest},
       angle_parameter("angular_diameter", 0.53, 0.0, 90.0,
                       "of the disk it comes from; 0 gives hard shadows"),
       radiance_parameter("irradiance", "on a surface that faces the light"),
       visible_parameter(),
       group_parameter()}};
  return declaration;
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "renderer/scene/declarations.h"
#include "renderer/scene/reader_tools.h"
#include "renderer/scene/readers.h"

namespace morsel::render {
namespace {

using nlohmann::json;
using params::JsonReader;
using params::Place;

float number(const JsonReader& reader, const char* name) {
  return static_cast<float>(reader.number(name));
}

void read_flags(const JsonReader& reader, LightFlags& flags) {
  flags.visible_to_camera = reader.boolean("visible_to_camera");
  flags.casts_shadow = reader.boolean("casts_shadow");
}

// Unit vector from "position" to "look_at".
Imath::V3d facing(const JsonReader& reader) {
  const Imath::V3d d = reader.vector3("look_at") - reader.vector3("position");
  if (!(d.length() > 0)) reader.place("look_at").fail("must differ from position");
  return d.normalized();
}

EnvironmentLight read_environment(const json& object, const Place& place) {
  const JsonReader reader(object, environment_light_declaration(), place);
  EnvironmentLight light;
  light.file = reader.string("file");
  light.radiance = to_float(reader.vector3("radiance"));
  light.rotation = static_cast<float>(reader.number("rotation"));
  light.visible_to_camera = reader.boolean("visible_to_camera");
  return light;
}

void place_by_edges(RectangleLight& light, const JsonReader& reader, const Place& place) {
  for (const char* key : {"corner", "edge_u", "edge_v"})
    if (!reader.has(key))
      place.fail(fmt::format("missing key \"{}\": corner, edge_u and edge_v go together", key));
  const Imath::V3d u = reader.vector3("edge_u"), v = reader.vector3("edge_v");
  if (u.length() == 0 || v.length() == 0 || nearly_parallel(u, v))
    (place / "edge_v").fail("edge_u and edge_v must span a rectangle, but are parallel or zero");
  if (std::abs(u.dot(v)) > 1e-4 * u.length() * v.length())
    (place / "edge_v").fail("edge_v must be perpendicular to edge_u");
  light.corner = to_float(reader.vector3("corner"));
  light.edge_u = to_float(u);
  light.edge_v = to_float(v);
}

void place_by_centre(RectangleLight& light, const JsonReader& reader, const Place& place) {
  for (const char* key : {"position", "look_at", "size"})
    if (!reader.has(key))
      place.fail(fmt::format("missing key \"{}\": position, look_at and size go together", key));
  const Imath::V3d position = reader.vector3("position");
  const Imath::V3d towards = reader.vector3("look_at") - position;
  if (!(towards.length() > 0)) (place / "look_at").fail("must differ from position");
  const Imath::V3d facing = towards.normalized();
  const Imath::V3d up =
      nearly_parallel(facing, {0, 1, 0}) ? Imath::V3d(0, 0, 1) : Imath::V3d(0, 1, 0);
  const Imath::V3d u = up.cross(facing).normalized();
  const Imath::V3d v = facing.cross(u);
  const Imath::V2d size = reader.vector2("size");
  light.corner = to_float(position - u * (size.x / 2) - v * (size.y / 2));
  light.edge_u = to_float(u * size.x);
  light.edge_v = to_float(v * size.y);
}

RectangleLight read_rectangle_light(const json& object, const Place& place) {
  const JsonReader reader(object, rectangle_light_declaration(), place);
  RectangleLight light;
  light.name = reader.string("name");
  const bool by_edges = reader.has("corner") || reader.has("edge_u") || reader.has("edge_v");
  const bool by_centre = reader.has("position") || reader.has("look_at") || reader.has("size");
  if (by_edges && by_centre)
    place.fail("corner, edge_u, edge_v and position, look_at, size exclude each other");
  if (by_centre)
    place_by_centre(light, reader, place);
  else
    place_by_edges(light, reader, place);
  light.radiance = to_float(reader.vector3("radiance"));
  read_flags(reader, light);
  return light;
}

EnvironmentLight read_sky(const JsonReader& reader) {
  EnvironmentLight light;
  SkyLight& sky = light.sky.emplace();
  sky.sun_elevation = number(reader, "sun_elevation");
  sky.sun_azimuth = number(reader, "sun_azimuth");
  sky.sun_diameter = number(reader, "sun_diameter");
  sky.turbidity = number(reader, "turbidity");
  sky.ground_color = to_float(reader.vector3("ground_color"));
  light.radiance = to_float(reader.vector3("radiance"));
  light.visible_to_camera = reader.boolean("visible_to_camera");
  return light;
}

DiskLight read_disk(const JsonReader& reader) {
  DiskLight light;
  light.name = reader.string("name");
  light.position = to_float(reader.vector3("position"));
  light.normal = to_float(facing(reader));
  light.radius = number(reader, "radius");
  light.radiance = to_float(reader.vector3("radiance"));
  read_flags(reader, light);
  return light;
}

SphereLight read_sphere_light(const JsonReader& reader) {
  SphereLight light;
  light.name = reader.string("name");
  light.position = to_float(reader.vector3("position"));
  light.radius = number(reader, "radius");
  light.radiance = to_float(reader.vector3("radiance"));
  read_flags(reader, light);
  return light;
}

PointLight read_point(const JsonReader& reader) {
  PointLight light;
  light.name = reader.string("name");
  light.position = to_float(reader.vector3("position"));
  if (reader.has("look_at")) light.direction = to_float(facing(reader));
  light.inner_angle = number(reader, "inner_angle");
  light.outer_angle = number(reader, "outer_angle");
  if (light.outer_angle < 180.0f && !reader.has("look_at"))
    reader.place("outer_angle").fail("a spot needs \"look_at\"");
  if (light.inner_angle > light.outer_angle)
    reader.place("inner_angle").fail("must not be greater than outer_angle");
  light.intensity = to_float(reader.vector3("intensity"));
  return light;
}

DistantLight read_distant(const JsonReader& reader) {
  DistantLight light;
  light.name = reader.string("name");
  const Imath::V3d direction = reader.vector3("direction");
  if (!(direction.length() > 0)) reader.place("direction").fail("must not be zero");
  light.direction = to_float(direction.normalized());
  light.angular_diameter = number(reader, "angular_diameter");
  light.irradiance = to_float(reader.vector3("irradiance"));
  light.visible_to_camera = reader.boolean("visible_to_camera");
  return light;
}

}  // namespace

std::uint32_t light_group(const JsonReader& reader, std::vector<std::string>& names) {
  const std::string name = reader.string("group");
  if (name.empty()) return kNoGroup;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return static_cast<std::uint32_t>(i);
  if (name.find_first_of(".\n\t ") != std::string::npos)
    reader.place("group").fail(
        fmt::format("\"{}\" becomes the name of an image layer: no spaces or dots", name));
  if (names.size() >= kMaxLightGroups)
    reader.place("group").fail(fmt::format("\"{}\" is one light group too many; at most {}: {}",
                                           name, kMaxLightGroups, params::join(names)));
  names.push_back(name);
  return static_cast<std::uint32_t>(names.size() - 1);
}

void read_light(const json& object, const Place& place, Scene& scene) {
  const std::string type = params::type_of(
      object, {"environment", "sky", "rectangle", "disk", "sphere", "point", "distant"}, place);
  const auto read = [&](const params::Declaration& declaration, auto&& make, auto& list) {
    const JsonReader reader(object, declaration, place);
    auto light = make(reader);
    light.group = light_group(reader, scene.light_groups);
    list.push_back(std::move(light));
  };
  if (type == "environment" || type == "sky") {
    const bool sky = type == "sky";
    const JsonReader reader(object, sky ? sky_light_declaration() : environment_light_declaration(),
                            place);
    EnvironmentLight light = sky ? read_sky(reader) : read_environment(object, place);
    if (scene.environment) place.fail("a scene has at most one environment or sky light");
    light.group = light_group(reader, scene.light_groups);
    scene.environment = std::move(light);
  } else if (type == "rectangle") {
    read(
        rectangle_light_declaration(),
        [&](const JsonReader&) { return read_rectangle_light(object, place); }, scene.rectangles);
  } else if (type == "disk") {
    read(disk_light_declaration(), read_disk, scene.disks);
  } else if (type == "sphere") {
    read(sphere_light_declaration(), read_sphere_light, scene.spheres);
  } else if (type == "point") {
    read(point_light_declaration(), read_point, scene.points);
  } else {
    read(distant_light_declaration(), read_distant, scene.distants);
  }
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/readers.h"

#include <fmt/format.h>

#include <cmath>

#include "renderer/scene/declarations.h"
#include "renderer/scene/transform.h"

namespace morsel::render {
namespace {

using nlohmann::json;
using params::JsonReader;
using params::Place;

Imath::V3f to_float(const Imath::V3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// Angle between `a` and `b` so small that their cross product gives no direction.
bool nearly_parallel(const Imath::V3d& a, const Imath::V3d& b) {
  return a.cross(b).length() <= 1e-6 * a.length() * b.length();
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
  light.visible_to_camera = reader.boolean("visible_to_camera");
  return light;
}

}  // namespace

PerspectiveCamera read_camera(const json& object, const Place& place) {
  const JsonReader reader(object, camera_declaration(), place);
  const Imath::V3d position = reader.vector3("position"), look_at = reader.vector3("look_at");
  const Imath::V3d up = reader.vector3("up");
  if (!((look_at - position).length() > 0))
    (place / "look_at").fail("must differ from the camera's position");
  if (!(up.length() > 0) || nearly_parallel(up, look_at - position))
    (place / "up").fail("must not be zero nor parallel to the viewing direction");
  PerspectiveCamera camera;
  camera.position = to_float(position);
  camera.look_at = to_float(look_at);
  camera.up = to_float(up);
  camera.vertical_fov = static_cast<float>(reader.number("vertical_fov"));
  return camera;
}

RenderSettings read_settings(const json& object, const Place& place) {
  const JsonReader reader(object, render_declaration(), place);
  const Imath::V2d resolution = reader.vector2("resolution");
  if (resolution.x != std::floor(resolution.x) || resolution.y != std::floor(resolution.y))
    (place / "resolution").fail("must be two integers");
  RenderSettings settings;
  settings.width = static_cast<int>(resolution.x);
  settings.height = static_cast<int>(resolution.y);
  settings.spp = static_cast<int>(reader.integer("spp"));
  settings.max_depth = static_cast<int>(reader.integer("max_depth"));
  settings.seed = static_cast<std::uint32_t>(reader.integer("seed"));
  settings.exposure = static_cast<float>(reader.number("exposure"));
  settings.regularization = static_cast<float>(reader.number("regularization"));
  return settings;
}

Material read_material(const json& object, const Place& place) {
  const std::string type = params::type_of(object, {"diffuse", "conductor", "dielectric"}, place);
  const params::Declaration& declaration = type == "diffuse"     ? diffuse_declaration()
                                           : type == "conductor" ? conductor_declaration()
                                                                 : dielectric_declaration();
  const JsonReader reader(object, declaration, place);
  Material material;
  material.name = reader.string("name");
  material.color = to_float(reader.vector3("color"));
  if (type == "diffuse") {
    material.type = MaterialType::kDiffuse;
    if (reader.has("checker_color"))
      material.checker_color = to_float(reader.vector3("checker_color"));
    material.checker_size = static_cast<float>(reader.number("checker_size"));
    return material;
  }
  material.roughness = static_cast<float>(reader.number("roughness"));
  if (type == "conductor") {
    material.type = MaterialType::kConductor;
    return material;
  }
  material.type = MaterialType::kDielectric;
  material.ior = static_cast<float>(reader.number("ior"));
  return material;
}

std::variant<EnvironmentLight, RectangleLight> read_light(const json& object, const Place& place) {
  const std::string type = params::type_of(object, {"environment", "rectangle"}, place);
  if (type == "environment") return read_environment(object, place);
  return read_rectangle_light(object, place);
}

InstanceEntry read_instance(const json& object, const Place& place) {
  const JsonReader reader(object, instance_declaration(), place);
  InstanceEntry entry;
  entry.geometry = reader.string("geometry");
  entry.material = reader.string("material");
  if (reader.has("detached_material")) entry.detached_material = reader.string("detached_material");
  entry.name = reader.string("name");
  if (entry.name.empty()) entry.name = entry.geometry;

  if (reader.has("transform")) {
    for (const char* key : {"translate", "rotate", "scale"})
      if (reader.has(key)) (place / key).fail("cannot be combined with \"transform\"");
    entry.object_to_world = read_transform(reader.object("transform"), reader.place("transform"));
    return entry;
  }
  entry.object_to_world = make_transform(reader.vector3("scale"), reader.vector3("rotate"),
                                         reader.vector3("translate"));
  if (!is_invertible(entry.object_to_world))
    (place / "scale").fail("must not flatten the geometry: no component may be 0");
  return entry;
}

std::uint32_t find_name(const std::string& name, const std::vector<std::string>& known,
                        const char* what, const Place& place) {
  for (std::size_t i = 0; i < known.size(); ++i)
    if (known[i] == name) return static_cast<std::uint32_t>(i);
  const std::string near = params::nearest_name(name, known);
  place.fail(fmt::format("no {} \"{}\"{}; there are: {}", what, name,
                         near.empty() ? "" : fmt::format(", did you mean \"{}\"?", near),
                         known.empty() ? "none" : params::join(known)));
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/readers.h"

#include <fmt/format.h>

#include <algorithm>

#include <cmath>

#include "renderer/scene/declarations.h"
#include "renderer/scene/reader_tools.h"
#include "renderer/scene/transform.h"

namespace morsel::render {
namespace {

using nlohmann::json;
using params::JsonReader;
using params::Place;

}  // namespace

SceneCamera read_camera(const json& object, const Place& place) {
  const JsonReader reader(object, camera_declaration(), place);
  const Imath::V3d position = reader.vector3("position"), look_at = reader.vector3("look_at");
  const Imath::V3d up = reader.vector3("up");
  if (!((look_at - position).length() > 0))
    (place / "look_at").fail("must differ from the camera's position");
  if (!(up.length() > 0) || nearly_parallel(up, look_at - position))
    (place / "up").fail("must not be zero nor parallel to the viewing direction");
  SceneCamera camera;
  camera.position = to_float(position);
  camera.look_at = to_float(look_at);
  camera.up = to_float(up);
  const std::string type = reader.string("type");
  camera.projection = type == "perspective"    ? Projection::kPerspective
                      : type == "orthographic" ? Projection::kOrthographic
                                               : Projection::kSpherical;
  camera.vertical_fov = static_cast<float>(reader.number("vertical_fov"));
  camera.height = static_cast<float>(reader.number("height"));
  camera.aperture_radius = static_cast<float>(reader.number("aperture_radius"));
  camera.focus_distance = static_cast<float>(reader.number("focus_distance"));
  camera.blades = static_cast<int>(reader.integer("blades"));
  camera.blade_rotation = static_cast<float>(reader.number("blade_rotation"));
  const Imath::V2d shutter = reader.vector2("shutter");
  if (shutter.x > shutter.y) (place / "shutter").fail("must not close before it opens");
  camera.shutter_open = static_cast<float>(shutter.x);
  camera.shutter_close = static_cast<float>(shutter.y);
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
  settings.noise_target = static_cast<float>(reader.number("noise_target"));
  settings.min_spp = static_cast<int>(reader.integer("min_spp"));
  const std::string filter = reader.string("filter");
  settings.filter = filter == "box"        ? PixelFilter::kBox
                    : filter == "triangle" ? PixelFilter::kTriangle
                    : filter == "gaussian" ? PixelFilter::kGaussian
                                           : PixelFilter::kBlackmanHarris;
  settings.filter_radius = reader.has("filter_radius")
                               ? static_cast<float>(reader.number("filter_radius"))
                           : filter == "box"      ? 0.5f
                           : filter == "triangle" ? 1.0f
                                                  : 1.5f;
  settings.texture_memory = static_cast<int>(reader.integer("texture_memory"));
  settings.cryptomatte = reader.boolean("cryptomatte");
  settings.denoise = reader.boolean("denoise");
  settings.max_depth = static_cast<int>(reader.integer("max_depth"));
  settings.seed = static_cast<std::uint32_t>(reader.integer("seed"));
  settings.max_diffuse_depth = static_cast<int>(reader.integer("max_diffuse_depth"));
  settings.max_glossy_depth = static_cast<int>(reader.integer("max_glossy_depth"));
  settings.max_transmission_depth = static_cast<int>(reader.integer("max_transmission_depth"));
  settings.indirect_clamp = static_cast<float>(reader.number("indirect_clamp"));
  settings.exposure = static_cast<float>(reader.number("exposure"));
  settings.regularization = static_cast<float>(reader.number("regularization"));
  return settings;
}

InstanceEntry read_instance(const json& object, const Place& place) {
  const JsonReader reader(object, instance_declaration(), place);
  InstanceEntry entry;
  entry.geometry = reader.string("geometry");
  entry.material = reader.string("material");
  if (reader.has("detached_material")) entry.detached_material = reader.string("detached_material");
  entry.name = reader.string("name");
  if (entry.name.empty()) entry.name = entry.geometry;
  entry.visible_to_camera = reader.boolean("visible_to_camera");
  entry.visible_to_bounces = reader.boolean("visible_to_bounces");
  entry.casts_shadow = reader.boolean("casts_shadow");

  if (reader.has("transform")) {
    for (const char* key :
         {"translate", "rotate", "scale", "translate_end", "rotate_end", "scale_end"})
      if (reader.has(key)) (place / key).fail("cannot be combined with \"transform\"");
    entry.object_to_world = read_transform(reader.object("transform"), reader.place("transform"));
    return entry;
  }
  entry.object_to_world = make_transform(reader.vector3("scale"), reader.vector3("rotate"),
                                         reader.vector3("translate"));
  if (!is_invertible(entry.object_to_world))
    (place / "scale").fail("must not flatten the geometry: no component may be 0");
  const auto end = [&](const char* key, const char* start) {
    return reader.vector3(reader.has(key) ? key : start);
  };
  if (reader.has("translate_end") || reader.has("rotate_end") || reader.has("scale_end")) {
    entry.object_to_world_end = make_transform(
        end("scale_end", "scale"), end("rotate_end", "rotate"), end("translate_end", "translate"));
    for (int k = 0; k <= 16; ++k) {
      const double t = k / 16.0;
      if (!is_invertible(entry.object_to_world * (1.0 - t) + *entry.object_to_world_end * t))
        (place / (reader.has("scale_end") ? "scale_end" : "rotate_end"))
            .fail("the straight way to there flattens the geometry");
    }
  }
  return entry;
}

std::uint32_t find_name(const std::string& name, const std::vector<std::string>& known,
                        const char* what, const Place& place) {
  for (std::size_t i = 0; i < known.size(); ++i)
    if (known[i] == name) return static_cast<std::uint32_t>(i);
  // Elements whose name is missing are listed without one, and textures for each way to read them.
  std::vector<std::string> names;
  for (const std::string& each : known)
    if (!each.empty() && std::find(names.begin(), names.end(), each) == names.end())
      names.push_back(each);
  const std::string near = params::nearest_name(name, names);
  place.fail(fmt::format("no {} \"{}\"{}; there are: {}", what, name,
                         near.empty() ? "" : fmt::format(", did you mean \"{}\"?", near),
                         names.empty() ? "none" : params::join(names)));
}

}  // namespace morsel::render

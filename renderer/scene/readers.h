// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathMatrix.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hypertexture_geom/params/json_reader.h"
#include "renderer/scene/scene.h"

// From the JSON objects of a scene file to the structs of scene.h. All throw params::InputError.
namespace morsel::render {

SceneCamera read_camera(const nlohmann::json& object, const params::Place& place);
RenderSettings read_settings(const nlohmann::json& object, const params::Place& place);

// Its textures are those of `scene`, to which new light groups are added.
Material read_material(const nlohmann::json& object, const params::Place& place, Scene& scene);

// An image's file is as written in the scene.
Texture read_texture(const nlohmann::json& object, const params::Place& place);
// The key under which a material names the texture of an input: "color_texture".
const char* texture_key(MaterialInput input);
// Sets the textures that the material names; scene.textures must be complete.
void read_material_textures(const params::JsonReader& reader,
                            std::initializer_list<MaterialInput> inputs, Scene& scene,
                            Material& material);

// Adds a light of any type to `scene`. The environment's file is as written in the scene.
void read_light(const nlohmann::json& object, const params::Place& place, Scene& scene);

// Index of the light group that the object's "group" names, which is added if it is new; kNoGroup
// if it names none.
std::uint32_t light_group(const params::JsonReader& reader, std::vector<std::string>& names);

// An instance by names; the loader turns them into indices.
struct InstanceEntry {
  std::string name;
  std::string geometry;
  std::string material;
  std::string detached_material;  // empty: none
  Imath::M44d object_to_world;    // row vectors, as Imath has it
  std::optional<Imath::M44d> object_to_world_end;
  bool visible_to_camera = true, visible_to_bounces = true, casts_shadow = true;
};
InstanceEntry read_instance(const nlohmann::json& object, const params::Place& place);

// The index of `name` in `known`; fails with the nearest name and all of them. `what` is
// "material".
std::uint32_t find_name(const std::string& name, const std::vector<std::string>& known,
                        const char* what, const params::Place& place);

}  // namespace morsel::render

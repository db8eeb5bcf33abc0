// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathMatrix.h>

#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "hypertexture_geom/params/json_reader.h"
#include "renderer/scene/scene.h"

// From the JSON objects of a scene file to the structs of scene.h. All throw params::InputError.
namespace morsel::render {

PerspectiveCamera read_camera(const nlohmann::json& object, const params::Place& place);
RenderSettings read_settings(const nlohmann::json& object, const params::Place& place);
Material read_material(const nlohmann::json& object, const params::Place& place);

// "environment" or "rectangle". The environment's file is as written in the scene.
std::variant<EnvironmentLight, RectangleLight> read_light(const nlohmann::json& object,
                                                          const params::Place& place);

// An instance by names; the loader turns them into indices.
struct InstanceEntry {
  std::string name;
  std::string geometry;
  std::string material;
  std::string detached_material;  // empty: none
  Imath::M44d object_to_world;    // row vectors, as Imath has it
};
InstanceEntry read_instance(const nlohmann::json& object, const params::Place& place);

// The index of `name` in `known`; fails with the nearest name and all of them. `what` is
// "material".
std::uint32_t find_name(const std::string& name, const std::vector<std::string>& known,
                        const char* what, const params::Place& place);

}  // namespace morsel::render

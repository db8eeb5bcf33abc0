// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "renderer/scene/scene.h"

namespace morsel::render {

// Everything static that a model file holds: a glTF's default scene with its node tree flattened
// (every node that has a mesh becomes instances of that mesh's primitives), materials, images,
// cameras and punctual lights; an OBJ with its MTL. Names are those of the file, made distinct. The
// scene's camera is the first one of the file, `has_camera` whether there is one. `warn` is told
// what is left out. Throws MeshError that names the file.
struct Model {
  Scene scene;
  bool has_camera = false;
};
Model load_model(const std::filesystem::path& file,
                 const std::function<void(const std::string&)>& warn);

struct ModelPlacement {
  std::string name;       // goes before the names of instances and materials
  Imath::M44d transform;  // of the whole, row vectors
  bool lights = true;
  bool camera = false;  // whether its camera becomes the scene's
};

// Appends everything that `model` holds.
void add_model(Model model, const ModelPlacement& placement, Scene& scene);

}  // namespace morsel::render

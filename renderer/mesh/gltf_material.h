// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "renderer/mesh/gltf_file.h"

namespace morsel::render {

// The materials of a glTF file with the textures they use, appended to `scene`, plus one more for
// primitives without a material: the last. Understood are the core of glTF 2.0 and KHR_materials_
// clearcoat, emissive_strength, ior, sheen, specular, transmission, unlit, volume,
// pbrSpecularGlossiness, and KHR_texture_transform. Throws GltfError.
void add_gltf_materials(const tinygltf::Model& model,
                        const std::function<void(const std::string&)>& warn, Scene& scene);

}  // namespace morsel::render

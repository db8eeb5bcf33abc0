// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/mesh/obj_check.h"
#include "renderer/scene/model.h"

namespace morsel::render {

// One reader per library; load_model picks one by the file's extension.
Model read_gltf_model(const std::filesystem::path& file,
                      const std::function<void(const std::string&)>& warn);
Model read_model_with_assimp(const std::filesystem::path& file, const ObjNames& names,
                             const std::function<void(const std::string&)>& warn);

}  // namespace morsel::render

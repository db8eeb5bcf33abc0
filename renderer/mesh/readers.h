// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "renderer/mesh/mesh_file.h"

// One reader per library; load_mesh picks one by the file's extension and validates what it gives.
namespace morsel::render {

TriangleMesh read_with_assimp(const std::filesystem::path& file);  // OBJ, PLY, STL
TriangleMesh read_gltf(const std::filesystem::path& file);         // .gltf, .glb

}  // namespace morsel::render

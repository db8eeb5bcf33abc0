// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "renderer/mesh/mesh_file.h"
#include "renderer/mesh/obj_check.h"

// One reader per library; load_mesh picks one by the file's extension and validates what it gives.
// `names`: of an OBJ, see check_obj().
namespace morsel::render {

TriangleMesh read_with_assimp(const std::filesystem::path& file,
                              const ObjNames& names);       // OBJ, PLY, STL
TriangleMesh read_gltf(const std::filesystem::path& file);  // .gltf, .glb

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <filesystem>

#include "renderer/mesh/obj_check.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// An OBJ, PLY or STL as assimp has it: validated, triangulated, identical vertices joined. Owned by
// `importer`. `names` are those of an OBJ. Normals may be those of group_normal(). Throws MeshError
// that names the file.
const aiScene& read_assimp_scene(Assimp::Importer& importer, const std::filesystem::path& file,
                                 const ObjNames& names);

// Appends the triangles of `part`; normals and texture coordinates that it lacks become 0.
void append_assimp_mesh(const aiMesh& part, TriangleMesh& mesh, const std::filesystem::path& file);

}  // namespace morsel::render

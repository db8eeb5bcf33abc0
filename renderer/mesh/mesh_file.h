// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "renderer/scene/scene.h"

namespace morsel::render {

// A mesh file that is missing, broken or holds no triangles. what() names the file.
struct MeshError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// ".obj", ".ply", ".stl", ".gltf", ".glb"
const std::vector<std::string>& mesh_extensions();

// Reads every triangle of the file into one mesh, in the file's own units and axes; transforms of
// glTF nodes are applied. Polygons are triangulated, points and lines left out, identical vertices
// joined. Normals and texture coordinates are kept where the file has them (v up, as OBJ and
// OpenImageIO's lower-left origin have it), normals unit length. The result passed
// validate_mesh. Throws MeshError.
TriangleMesh load_mesh(const std::filesystem::path& file);

// Throws MeshError that begins with `place`: no triangles, an index out of range, a number that is
// not finite, or attribute arrays whose length differs from that of the positions.
void validate_mesh(const TriangleMesh& mesh, const std::string& place);

}  // namespace morsel::render

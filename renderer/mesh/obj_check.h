// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace morsel::render {

// What an OBJ file names, each name once, in order of appearance, and how it is shaded.
struct ObjNames {
  std::vector<std::string> libraries;  // mtllib
  std::vector<std::string> materials;  // usemtl
  std::int64_t normals = 0;            // lines vn
  // Facets without normals are there, and lines `s` that say how to smooth them.
  bool smoothing_groups = false;
};

// Reads an OBJ file for its mistakes, of which assimp's own reader takes no notice: it takes what
// it can't read for zero, or for the start of the next line. Throws MeshError that names the line
// and the word when a vertex, normal or texture coordinate (lines v, vn, vt) has anything but
// finite numbers, or too few, and when a face, line or point (f, l, p) names a vertex, texture
// coordinate or normal that the file does not have.
ObjNames check_obj(const std::filesystem::path& file);

}  // namespace morsel::render

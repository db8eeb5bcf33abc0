// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace morsel::render {

// Throws MeshError that names the line and the word when a vertex, normal or texture coordinate of
// an OBJ file (lines v, vn, vt) has anything but finite numbers. Assimp's own reader takes what it
// can't read for zero, or for the start of the next line.
void check_obj_numbers(const std::filesystem::path& file);

}  // namespace morsel::render

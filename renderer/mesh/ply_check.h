// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace morsel::render {

// Reads a PLY file for its mistakes, some of which end assimp's own reader, and the process with
// it: what the header declares must be known and make sense, and the values that it announces must
// be there. Throws MeshError that names the line of the header, or the element.
void check_ply(const std::filesystem::path& file);

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <assimp/IOSystem.hpp>
#include <filesystem>
#include <memory>

#include "renderer/mesh/obj_check.h"

namespace morsel::render {

// Assimp takes no notice of smoothing groups. This lets it read the OBJ `file`, which was checked
// and has `names`, as if every facet without normals had those of group_normal() (normals.h), which
// normalise_normals() then replaces. A facet under `s off` or `s 0`, or before the first `s`, is a
// group of its own: it stays flat. Other files are read as they are.
std::unique_ptr<Assimp::IOSystem> read_groups_as_normals(const std::filesystem::path& file,
                                                         const ObjNames& names);

}  // namespace morsel::render

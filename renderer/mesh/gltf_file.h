// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathMatrix.h>
#include <tiny_gltf.h>

#include <filesystem>
#include <functional>
#include <optional>

#include "renderer/mesh/gltf_accessor.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// Parses a .gltf or .glb. Encoded images are kept as they are in Image::image; one that is missing
// is empty. Throws GltfError, also for extensions that the file says cannot be ignored and that are
// not known here.
tinygltf::Model parse_gltf(const std::filesystem::path& file);

// Calls visit(node, index, node to world) for every node of the default scene, parents first; row
// vectors, as Imath has them. Throws GltfError for nodes that do not exist or are no tree.
void for_each_node(
    const tinygltf::Model& model,
    const std::function<void(const tinygltf::Node&, int, const Imath::M44d&)>& visit);

// The triangles of a primitive in its own space; none for points, lines and what has no positions.
// Normals, texture coordinates (of sets 0 and 1, v up) and colors (of set 0) are empty where the
// file has none. Throws GltfError that names the primitive.
std::optional<TriangleMesh> read_primitive(const tinygltf::Model& model, std::size_t mesh,
                                           std::size_t primitive);
// For messages: numbers and name.
std::string primitive_place(const tinygltf::Model& model, std::size_t mesh, std::size_t primitive);

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>
#include <tiny_gltf.h>

#include <cstdint>
#include <stdexcept>
#include <vector>

namespace morsel::render {

// What is wrong with a glTF file's data, without the file's name.
struct GltfError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Element-wise copies of accessors of the given kind, sparse ones included. Every index, offset and
// count of the file is checked against the buffer that it leads into. Throw GltfError.

// Floats or integers, as KHR_mesh_quantization allows them for positions and normals.
std::vector<Imath::V3f> read_vectors3(const tinygltf::Model& model, int accessor);
// Texture coordinates: float, or normalised integers.
std::vector<Imath::V2f> read_vectors2(const tinygltf::Model& model, int accessor);
// Of 3 or 4 components, the alpha of which is left out: float, or normalised integers.
// `alphas` stays empty where there are none.
std::vector<Imath::V3f> read_colors(const tinygltf::Model& model, int accessor,
                                    std::vector<float>& alphas);
// 8, 16 or 32 bit, unsigned.
std::vector<std::uint32_t> read_indices(const tinygltf::Model& model, int accessor);

}  // namespace morsel::render

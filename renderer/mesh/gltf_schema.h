// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace morsel::render {

// Throws GltfError that names place, value and what should be there when something in the JSON of a
// glTF file has the wrong type, which tinygltf passes over as if it were absent, or when an image
// lies in no buffer or beyond its end, where tinygltf reads all the same. Only what is read here is
// looked at. Text that is no JSON is left to the parser.
void check_gltf_types(const std::string& json);

}  // namespace morsel::render

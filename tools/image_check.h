// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace morsel::tools {

// Reads an image's header. Throws std::runtime_error that names the file when that fails or the
// image is not a plain picture. For render::LoadOptions::check_image.
void check_image(const std::filesystem::path& file);

}  // namespace morsel::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>
#include <OpenImageIO/imageio.h>

#include "renderer/scene/texture.h"

namespace morsel::render {

// Side of its tiles; level k is of max(1, size >> k) texels.
inline constexpr int kLinearImageTile = 64;

// An image as OpenImageIO's cache should see it: scene-linear, so that mip levels and filters mix
// light and not its sRGB encoding; from a file, or from an encoded image in memory. Made by the
// cache itself, which passes `configuration` to open().
OIIO::ImageInput* create_linear_image();
OIIO::ImageSpec linear_image_configuration(const ImageTexture& image);

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "tools/image_check.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <stdexcept>

namespace morsel::tools {

void check_image(const std::filesystem::path& file) {
  const auto input = OIIO::ImageInput::open(file.string());
  if (!input)
    throw std::runtime_error(fmt::format("{}: cannot read: {}", file.string(), OIIO::geterror()));
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.deep)
    throw std::runtime_error(fmt::format("{}: must be a flat picture", file.string()));
}

}  // namespace morsel::tools

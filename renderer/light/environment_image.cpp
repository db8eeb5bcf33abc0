// SPDX-License-Identifier: Apache-2.0
// Apart from environment.cpp so that what needs no image file need not load OpenImageIO.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <memory>
#include <stdexcept>

#include "renderer/light/environment.h"

namespace morsel::render {

EnvironmentImage EnvironmentImage::read(const std::string& file) {
  const auto input = OIIO::ImageInput::open(file);
  if (!input)
    throw std::runtime_error(
        fmt::format("{}: cannot read the environment: {}", file, OIIO::geterror()));
  const OIIO::ImageSpec& spec = input->spec();
  const int channels = spec.nchannels;
  if (spec.width < 1 || spec.height < 1 || channels < 1)
    throw std::runtime_error(fmt::format("{}: the environment has no pixels", file));

  // Channels come back in the file's order: find them by name, else take the first three.
  int red = 0, green = channels >= 3 ? 1 : 0, blue = channels >= 3 ? 2 : 0;
  const int r = spec.channelindex("R"), g = spec.channelindex("G"), b = spec.channelindex("B");
  if (r >= 0 && g >= 0 && b >= 0) red = r, green = g, blue = b;

  const auto count = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  std::vector<float> data(count * static_cast<std::size_t>(channels));
  if (!input->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, data.data()))
    throw std::runtime_error(
        fmt::format("{}: cannot read the environment: {}", file, input->geterror()));

  const auto usable = [](float x) { return std::isfinite(x) && x > 0.0f ? x : 0.0f; };
  EnvironmentImage image;
  image.width = spec.width;
  image.height = spec.height;
  image.texels.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float* texel = &data[i * static_cast<std::size_t>(channels)];
    image.texels[i] = V3f(usable(texel[red]), usable(texel[green]), usable(texel[blue]));
  }
  return image;
}

}  // namespace morsel::render

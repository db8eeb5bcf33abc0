// SPDX-License-Identifier: Apache-2.0
#include "renderer/image/png.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

#include "renderer/image/tone_map.h"
#include "topology/replacing_file.h"

namespace morsel::render {
namespace {

std::uint8_t to_byte(float x) { return static_cast<std::uint8_t>(std::lround(x * 255.0f)); }

}  // namespace

void write_png(const std::filesystem::path& path, const Film& film, float exposure,
               const std::vector<V3f>& denoised) {
  const Crop& window = film.window();
  std::vector<std::uint8_t> bytes;
  bytes.reserve(4u * static_cast<std::size_t>(film.width()) *
                static_cast<std::size_t>(film.height()));
  for (int y = window.y0; y < window.y1; ++y)
    for (int x = window.x0; x < window.x1; ++x) {
      const Pixel& p = film.at(x, y);
      const float alpha = std::clamp(p.alpha, 0.0f, 1.0f);
      const V3f& radiance = denoised.empty() ? p.color : denoised[bytes.size() / 4];
      const V3f c = tone_map(alpha > 0.0f ? radiance / alpha : V3f(0.0f), exposure);
      bytes.insert(bytes.end(), {to_byte(c.x), to_byte(c.y), to_byte(c.z), to_byte(alpha)});
    }

  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(fmt::format("{}: cannot write: {}", path.string(), why));
  };
  // The format is asked for by name: the path may have any extension. Encoded in memory, because
  // OpenImageIO's writer reports no error when the disk is full.
  const auto output = OIIO::ImageOutput::create("png");
  if (!output) fail(OIIO::geterror());
  OIIO::ImageSpec spec(film.width(), film.height(), 4, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("Software", "Morsel " MORSEL_VERSION);
  OIIO::Filesystem::IOVecOutput encoded;
  if (!output->set_ioproxy(&encoded) || !output->open("png", spec)) fail(output->geterror());
  if (!output->write_image(OIIO::TypeDesc::UINT8, bytes.data())) fail(output->geterror());
  if (!output->close()) fail(output->geterror());

  topology::ReplacingFile file(path);
  std::ofstream stream(file.temporary_path(), std::ios::binary);
  stream.write(reinterpret_cast<const char*>(encoded.buffer().data()),
               static_cast<std::streamsize>(encoded.buffer().size()));
  stream.close();
  if (!stream) fail(std::strerror(errno));
  file.commit();
}

}  // namespace morsel::render

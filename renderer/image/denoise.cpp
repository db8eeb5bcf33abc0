// SPDX-License-Identifier: Apache-2.0
#include "renderer/image/denoise.h"

#include <fmt/format.h>

#include <stdexcept>

#ifdef MORSEL_HAS_DENOISER
#include <OpenImageDenoise/oidn.hpp>
#endif

namespace morsel::render {

#ifdef MORSEL_HAS_DENOISER

std::string denoiser_version() {
  return fmt::format("{}.{}.{}", OIDN_VERSION_MAJOR, OIDN_VERSION_MINOR, OIDN_VERSION_PATCH);
}

std::vector<V3f> denoise(const Film& film) {
  const auto width = static_cast<std::size_t>(film.width());
  const auto height = static_cast<std::size_t>(film.height());
  std::vector<V3f> color, albedo, normal, result(width * height);
  const Crop& window = film.window();
  for (int y = window.y0; y < window.y1; ++y)
    for (int x = window.x0; x < window.x1; ++x) {
      const Pixel& p = film.at(x, y);
      color.push_back(p.color);
      albedo.push_back(p.albedo);
      normal.push_back(p.normal);
    }
  // The processor: other devices do not see the process's memory.
  oidn::DeviceRef device = oidn::newDevice(oidn::DeviceType::CPU);
  device.commit();
  oidn::FilterRef filter = device.newFilter("RT");
  const auto set = [&](const char* name, std::vector<V3f>& image) {
    filter.setImage(name, image.data(), oidn::Format::Float3, width, height);
  };
  set("color", color);
  set("albedo", albedo);
  set("normal", normal);
  set("output", result);
  filter.set("hdr", true);
  filter.commit();
  filter.execute();
  const char* message = nullptr;
  if (device.getError(message) != oidn::Error::None)
    throw std::runtime_error(fmt::format("Open Image Denoise: {}", message));
  return result;
}

#else

std::string denoiser_version() { return {}; }

std::vector<V3f> denoise(const Film&) {
  throw std::runtime_error("this build has no Open Image Denoise");
}

#endif

}  // namespace morsel::render

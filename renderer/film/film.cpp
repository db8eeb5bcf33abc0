// SPDX-License-Identifier: Apache-2.0
#include "renderer/film/film.h"

#include <fmt/format.h>

#include <stdexcept>

namespace morsel::render {

Crop window_of(const RenderSettings& settings) {
  const int width = settings.width, height = settings.height;
  if (width < 1 || height < 1)
    throw std::invalid_argument(fmt::format("film: image of {} x {} pixels", width, height));
  const Crop w = settings.crop.value_or(Crop{0, 0, width, height});
  if (w.x0 < 0 || w.y0 < 0 || w.x1 > width || w.y1 > height || w.x0 >= w.x1 || w.y0 >= w.y1)
    throw std::invalid_argument(fmt::format(
        "film: crop [{}, {}) x [{}, {}) is empty or not inside the image of {} x {} pixels", w.x0,
        w.x1, w.y0, w.y1, width, height));
  return w;
}

Film::Film(const RenderSettings& settings, std::size_t light_groups)
    : full_width_(settings.width), full_height_(settings.height), window_(window_of(settings)) {
  const std::size_t count = static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
  pixels_.resize(count);
  groups_.assign(light_groups, std::vector<V3f>(count, V3f(0.0f)));
  if (settings.cryptomatte) mattes_.assign(3, std::vector<cryptomatte::Ranks>(count));
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "renderer/film/film.h"

namespace morsel::render::testing {

// Mean of the red channel over all pixels, and its standard error from the film's own variance.
struct Mean {
  double value = 0.0, error = 0.0;
};
inline Mean mean_of(const Film& film) {
  Mean m;
  double variance = 0.0;
  const Crop& w = film.window();
  for (int y = w.y0; y < w.y1; ++y)
    for (int x = w.x0; x < w.x1; ++x) {
      m.value += film.at(x, y).color.x;
      variance += film.at(x, y).variance.x;
    }
  const double n = 1.0 * film.width() * film.height();
  m.value /= n;
  m.error = std::sqrt(variance) / n;
  return m;
}

}  // namespace morsel::render::testing

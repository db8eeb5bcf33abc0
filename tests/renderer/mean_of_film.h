// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "renderer/film/film.h"

namespace morsel::render::testing {

// Mean of the red channel over all pixels, or those of a window, and its standard error from the
// film's own variance.
struct Mean {
  double value = 0.0, error = 0.0;
};
inline Mean mean_of(const Film& film, const Crop& w) {
  Mean m;
  double variance = 0.0;
  for (int y = w.y0; y < w.y1; ++y)
    for (int x = w.x0; x < w.x1; ++x) {
      m.value += film.at(x, y).color.x;
      variance += film.at(x, y).variance.x;
    }
  const double n = 1.0 * (w.x1 - w.x0) * (w.y1 - w.y0);
  m.value /= n;
  m.error = std::sqrt(variance) / n;
  return m;
}
inline Mean mean_of(const Film& film) { return mean_of(film, film.window()); }

}  // namespace morsel::render::testing

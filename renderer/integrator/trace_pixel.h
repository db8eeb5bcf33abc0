// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "renderer/accel/interaction.h"
#include "renderer/accel/ray_log.h"
#include "renderer/film/pixel.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// One sample of a pixel, looked at closely.
struct TracedSample {
  std::uint32_t half = 0, index = 0;  // adaptive sampling has two halves (PixelRenderer)
  V2f film{0.0f};                     // place in the image, pixels
  PathSample sample;
  std::vector<RayLog::Record> rays;  // in the order in which Embree was asked
};

struct TracedPixel {
  std::vector<TracedSample> samples;
  Pixel pixel;  // as in the film
};

// The samples that render() gives the pixel, on the calling thread, and what becomes of them.
// Throws what render() throws, and std::invalid_argument for a pixel outside the image.
TracedPixel trace_pixel(const Scene& scene, int x, int y);

}  // namespace morsel::render

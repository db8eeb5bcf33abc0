// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "renderer/accel/interaction.h"
#include "renderer/accel/ray_log.h"
#include "renderer/film/pixel.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// A ray that Embree was asked about, and what it met.
struct TracedRay {
  RTCRay ray;  // as it was asked
  RayLog::Query query;
  // The first hit; of a ray that asked only whether there is one, what is in its way.
  std::optional<SurfaceInteraction> met;
};

// One sample of a pixel, looked at closely.
struct TracedSample {
  std::uint32_t half = 0, index = 0;  // adaptive sampling has two halves (PixelRenderer)
  V2f film{0.0f};                     // place in the image, pixels
  PathSample sample;
  std::vector<TracedRay> rays;  // in the order in which Embree was asked
};

struct TracedPixel {
  std::vector<TracedSample> samples;
  Pixel pixel;  // as in the film
};

// The samples that render() gives the pixel, on the calling thread, and what becomes of them.
// Throws what render() throws, and std::invalid_argument for a pixel outside the image.
TracedPixel trace_pixel(const Scene& scene, int x, int y);

}  // namespace morsel::render

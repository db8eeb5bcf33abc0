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
  V2f film{0.0f};  // place in the image, pixels
  PathSample sample;
  std::vector<RayLog::Record> rays;  // in the order in which Embree was asked
};

// The samples that render() gives the pixel without adaptive sampling, on the calling thread.
// Throws what render() throws, and std::invalid_argument for a pixel outside the image.
std::vector<TracedSample> trace_pixel(const Scene& scene, int x, int y);

}  // namespace morsel::render

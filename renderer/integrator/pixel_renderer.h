// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/film/matte_names.h"
#include "renderer/film/pixel_filter.h"
#include "renderer/integrator/path_tracer.h"

namespace morsel::render {

// Work that tiles do on their own and hand in at their end.
struct TileCounts {
  RayCounts rays;
  std::uint64_t samples = 0, non_finite = 0, fireflies = 0;
  float brightest = 0.0f;
  Film::Components components;
};

// All samples of one pixel, written to a film.
//
// Adaptive sampling must not let what the samples happen to be decide how many of them count, or
// the mean is biased (pixels whose highlights were missed would stop early). So a pixel has two
// halves with independent random numbers: the first samples of each say how many the *other* needs,
// and the pixel is the mean of the halves' means, each of which is unbiased because its number of
// samples does not depend on its own values.
class PixelRenderer {
 public:
  PixelRenderer(const PathTracer& tracer, const Camera& camera, const RenderSettings& settings,
                const MatteNames* mattes);

  void render(int x, int y, Film& film, TileCounts& counts) const;

 private:
  struct Half;
  void add_samples(Half& half, int count, int x, int y, TileCounts& counts) const;
  int samples_needed(const PixelAccumulator& other) const;

  const PathTracer& tracer_;
  const Camera& camera_;
  const RenderSettings& settings_;
  const MatteNames* mattes_;
  FilterSampler filter_;
};

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "renderer/film/film_sums.h"
#include "renderer/film/matte_names.h"
#include "renderer/film/pixel_filter.h"
#include "renderer/integrator/non_finite.h"
#include "renderer/integrator/path_tracer.h"

namespace morsel::render {

// Brings pixels forward by samples.
//
// Adaptive sampling must not let what the samples happen to be decide how many of them count, or
// the mean is biased (pixels whose highlights were missed would stop early). So a pixel has two
// halves with independent random numbers: the first samples of each say how many the *other* needs,
// and the pixel is the mean of the halves' means, each of which is unbiased because its number of
// samples does not depend on its own values.
//
// With shards, every one of them traces those first samples, to come to the same decision, but
// counts only those of its own range.
class PixelRenderer {
 public:
  // Told of each sample that counts, after it was traced: of which half, its index there, its place
  // in the image in pixels, and what it found, as the path tracer gave it.
  using Watch = std::function<void(std::uint32_t half, std::uint32_t index, const V2f& film,
                                   const PathSample&)>;

  PixelRenderer(const PathTracer& tracer, const Camera& camera, const RenderSettings& settings,
                const MatteNames* mattes, Shard shard, NonFiniteReport& non_finite,
                const Watch* watch = nullptr);

  // Ends with at least min(target, all) of the shard's own samples in each half, and where it began
  // with more, with those: pixels are the same whatever targets they went through.
  void advance(int x, int y, std::uint32_t target, TileSums& tile) const;

  // The most own samples that a half can need, and the first target that makes sense.
  std::uint32_t most_samples() const;
  std::uint32_t first_target() const;

 private:
  struct Half;
  Half half(int x, int y, std::uint32_t which, TileSums& tile) const;
  PathSample trace(const Half& half, std::uint32_t index, V2f& offset, RayCounts& rays) const;
  void add_samples(Half& half, std::uint32_t target, Shard::Range range,
                   LuminanceStatistics* luminances) const;
  void decide(Half& first, Half& second) const;
  std::uint32_t samples_needed(const LuminanceStatistics& other) const;
  bool adaptive() const;

  const PathTracer& tracer_;
  const Camera& camera_;
  const RenderSettings& settings_;
  const MatteNames* mattes_;
  Shard shard_;
  NonFiniteReport& non_finite_;
  FilterSampler filter_;
  const Watch* watch_;
};

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <type_traits>

#include "renderer/film/exact_sum.h"
#include "renderer/film/pixel.h"

namespace morsel::render {

// The samples of one pixel; the filter is in where they are. Their order does not matter, nor
// whether they were added one by one or as accumulators. Its bytes are what checkpoints and shards
// keep: trivially copyable, without padding.
class PixelAccumulator {
 public:
  // `x`, `y`: position relative to the pixel's corner, beyond [0, 1) under wide filters. `index`:
  // of the sample in the pixel's sequence. Non-finite radiance must not come here.
  void add(const PathSample& sample, float x, float y, std::uint32_t index);
  // Samples with other indices.
  void add(const PixelAccumulator& other);

  // Whether up to `most` samples can have added up to this: nothing overflows when more are added,
  // and what comes of it is finite. To be asked of bytes that come from a file.
  bool is_possible(std::uint32_t most) const;

  std::uint32_t samples() const { return samples_; }
  Pixel result() const;
  // Luminance of the brightest sample, and whether it alone is more than half of the pixel (of 16
  // samples or more).
  float brightest() const { return brightest_; }
  bool firefly() const;

 private:
  ColorSum color_;
  SquareSum squares_;
  SmallSum albedo_[3], normal_[3], alpha_;
  std::int64_t steps_ = 0;
  // Of the sample nearest to the pixel's centre, the earliest of several.
  float nearest_ = std::numeric_limits<float>::infinity();
  std::uint32_t nearest_index_ = 0xffffffffu;
  float depth_ = kFarDepth, component_ = 0.0f;
  float position_[3] = {0.0f, 0.0f, 0.0f}, geometric_normal_[3] = {0.0f, 0.0f, 0.0f};
  float brightest_ = 0.0f;
  std::uint32_t samples_ = 0;
};
static_assert(std::is_trivially_copyable_v<PixelAccumulator> && sizeof(PixelAccumulator) == 208);

// Mean luminance of samples and the variance of one, for adaptive sampling (Welford's recurrence).
class LuminanceStatistics {
 public:
  void add(float luminance) {
    ++count_;
    const double deviation = luminance - mean_;
    mean_ += deviation / count_;
    squares_ += deviation * (luminance - mean_);
  }
  double mean() const { return mean_; }
  double variance() const { return count_ > 1 ? squares_ / (count_ - 1.0) : 0.0; }

 private:
  std::uint32_t count_ = 0;
  double mean_ = 0.0, squares_ = 0.0;
};

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/math/vector.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// Where in and around a pixel samples lie. The filter is sampled rather than applied ("filter
// importance sampling", Ernst, Stamminger & Greiner 2006): every sample counts the same and belongs
// to one pixel, so pixels stay independent, and so do crops. All filters are positive.
class FilterSampler {
 public:
  FilterSampler(PixelFilter filter, float radius);

  // Offset from the pixel's centre, within `radius`, of random numbers in [0, 1).
  V2f sample(const V2f& u) const { return {sample(u.x), sample(u.y)}; }

 private:
  float sample(float u) const;

  PixelFilter filter_;
  float radius_;
  static constexpr int kSteps = 256;
  float inverse_[kSteps + 1];  // of the cumulative distribution, in units of the radius
};

}  // namespace morsel::render

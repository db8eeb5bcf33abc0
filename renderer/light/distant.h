// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/light/light.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// A disk infinitely far away, like the sun; of angular diameter 0 it is a direction that only light
// samples find.
class Distant {
 public:
  // Throws std::invalid_argument naming the light.
  explicit Distant(const DistantLight& light);

  V3f radiance(const V3f& wi) const;
  LightSample sample(const V2f& u) const;
  float pdf(const V3f& wi) const;
  float importance() const { return luminance(irradiance_); }

 private:
  bool delta() const { return !(rim_ > 0.0); }
  bool contains(const V3f& wi) const;

  V3f towards_, irradiance_, radiance_;
  double rim_;  // 1 - cos of half its diameter
};

}  // namespace morsel::render

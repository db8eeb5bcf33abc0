// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/light/light.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// A disk that emits to the side that its normal points to. Sampled uniformly in area.
class Disk {
 public:
  // Throws std::invalid_argument naming the light when it has no area or is not finite.
  explicit Disk(const DiskLight& light);

  V3f radiance(const V3f& wi) const { return dot(wi, normal_) < 0.0f ? radiance_ : V3f(0.0f); }
  const V3f& normal() const { return normal_; }

  LightSample sample(const V3f& p, const V2f& u) const;
  float pdf(const V3f& p, const V3f& wi, float distance) const;
  float importance(const V3f& p) const;
  LightBounds bounds() const;

 private:
  V3f centre_, normal_, radiance_;
  float radius_, area_;
};

}  // namespace morsel::render

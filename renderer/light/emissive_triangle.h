// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/light/light.h"

namespace morsel::render {

// A triangle of a mesh whose material emits, on both sides. Sampled uniformly in area, its radiance
// being the mean of what the material emits.
class EmissiveTriangle {
 public:
  EmissiveTriangle(const V3f& a, const V3f& b, const V3f& c, const V3f& radiance);

  V3f radiance(const V3f& /*wi*/) const { return radiance_; }
  float area() const { return area_; }

  LightSample sample(const V3f& p, const V2f& u) const;
  float pdf(const V3f& p, const V3f& wi, float distance) const;
  float importance(const V3f& p) const;
  LightBounds bounds() const;

 private:
  V3f a_, edge_b_, edge_c_, normal_, radiance_;
  float area_;
};

}  // namespace morsel::render

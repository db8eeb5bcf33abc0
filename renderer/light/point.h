// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/light/light.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// A point that shines in all directions, or in a cone that fades towards its edge as
// KHR_lights_punctual has it. Only light samples find it.
class Point {
 public:
  // Throws std::invalid_argument naming the light.
  explicit Point(const PointLight& light);

  V3f radiance(const V3f& /*wi*/) const { return V3f(0.0f); }  // never hit
  LightSample sample(const V3f& p, const V2f& u) const;
  float pdf(const V3f& /*p*/, const V3f& /*wi*/, float /*distance*/) const { return 0.0f; }
  float importance(const V3f& p) const;
  LightBounds bounds() const;

 private:
  // Share of the intensity that leaves in unit direction `w`.
  float falloff(const V3f& w) const;

  V3f position_, axis_, intensity_;
  float outer_cosine_, scale_;
};

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/light/light.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// A sphere that emits outwards. Sampled uniformly in the solid angle it subtends, which is exact:
// the estimate of its irradiance has no noise but that of visibility and the cosine.
class Ball {
 public:
  // Throws std::invalid_argument naming the light when it has no radius or is not finite.
  explicit Ball(const SphereLight& light);

  V3f radiance(const V3f& /*wi*/) const { return radiance_; }
  const V3f& centre() const { return centre_; }

  // pdf 0 when `p` is inside.
  LightSample sample(const V3f& p, const V2f& u) const;
  float pdf(const V3f& p, const V3f& wi, float distance) const;
  float importance(const V3f& p) const;
  LightBounds bounds() const;

 private:
  // 1 - cos of half the angle it subtends; 0 inside.
  double rim(const V3f& p) const;

  V3f centre_, radiance_;
  float radius_;
};

}  // namespace morsel::render

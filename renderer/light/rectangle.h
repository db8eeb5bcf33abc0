// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/light/light.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// A parallelogram that emits from the side that cross(edge_u, edge_v) points to.
//
// True rectangles are sampled uniformly in the solid angle they subtend (Urena, Fajardo & King, "An
// Area-Preserving Parametrization for Spherical Rectangles", 2013), which removes the noise of the
// distance and cosine terms; skewed or very small ones (seen from the point) uniformly in area.
class Rectangle {
 public:
  // Throws std::invalid_argument naming the light when it has no area or is not finite.
  explicit Rectangle(const RectangleLight& light);

  V3f radiance(const V3f& wi) const { return dot(wi, normal_) < 0.0f ? radiance_ : V3f(0.0f); }
  const V3f& normal() const { return normal_; }

  // From a point `p`; pdf 0 when `p` is behind the light.
  LightSample sample(const V3f& p, const V2f& u) const;
  // The density of sample(p) in unit direction `wi`, which hits the light at `distance`.
  float pdf(const V3f& p, const V3f& wi, float distance) const;
  // Roughly the irradiance it can cause at `p`; 0 exactly where it casts no light.
  float importance(const V3f& p) const;
  LightBounds bounds() const;

 private:
  struct SphericalRectangle;

  V3f corner_, edge_u_, edge_v_, radiance_;
  V3f normal_, axis_u_, axis_v_;  // unit
  float length_u_, length_v_, area_, power_;
  bool right_angled_;
};

}  // namespace morsel::render

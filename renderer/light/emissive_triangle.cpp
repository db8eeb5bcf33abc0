// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/emissive_triangle.h"

namespace morsel::render {

EmissiveTriangle::EmissiveTriangle(const V3f& a, const V3f& b, const V3f& c, const V3f& radiance)
    : a_(a), edge_b_(b - a), edge_c_(c - a), radiance_(radiance) {
  const V3f n = cross(edge_b_, edge_c_);
  const float length = std::sqrt(dot(n, n));
  area_ = 0.5f * length;
  normal_ = length > 0.0f ? n / length : V3f(0.0f, 0.0f, 1.0f);
}

LightSample EmissiveTriangle::sample(const V3f& p, const V2f& u) const {
  const float root = std::sqrt(u.x);
  const V3f to_light = a_ + edge_b_ * (root * (1.0f - u.y)) + edge_c_ * (root * u.y) - p;
  const float distance2 = dot(to_light, to_light);
  LightSample s;
  s.on_light = V2f(root * (1.0f - u.y), root * u.y);
  s.distance = std::sqrt(distance2);
  s.wi = to_light / s.distance;
  const float cosine = std::abs(dot(s.wi, normal_));
  if (!(distance2 > 0.0f) || !(cosine * area_ > 0.0f)) return {};
  s.pdf = distance2 / (cosine * area_);
  s.radiance = radiance_;
  return s;
}

float EmissiveTriangle::pdf(const V3f& /*p*/, const V3f& wi, float distance) const {
  const float cosine = std::abs(dot(wi, normal_));
  return cosine * area_ > 0.0f ? distance * distance / (cosine * area_) : 0.0f;
}

float EmissiveTriangle::importance(const V3f& p) const { return bounds().importance(p); }

LightBounds EmissiveTriangle::bounds() const {
  LightBounds b;
  const V3f corners[] = {a_, a_ + edge_b_, a_ + edge_c_};
  for (const V3f& corner : corners)
    for (int i = 0; i < 3; ++i) {
      b.low[i] = std::min(b.low[i], corner[i]);
      b.high[i] = std::max(b.high[i], corner[i]);
    }
  b.axis = normal_;
  b.spread = 0.0f;
  b.two_sided = true;
  b.power = luminance(radiance_) * area_;
  return b;
}

}  // namespace morsel::render

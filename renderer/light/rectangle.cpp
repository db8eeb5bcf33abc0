// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/rectangle.h"

#include <fmt/format.h>

#include <stdexcept>

namespace morsel::render {
namespace {

// Sums of angles lose their digits for small solid angles; area sampling is as good there.
constexpr double kSmallestSolidAngle = 1e-3;

}  // namespace

// The rectangle seen from a point, in the coordinates of its own axes: it spans [x0, x1] x [y0, y1]
// in the plane z = z0 < 0. Notation of the paper.
struct Rectangle::SphericalRectangle {
  double x0, x1, y0, y1, z0, b0, b1, k, solid_angle;

  SphericalRectangle(const Rectangle& r, const V3f& p) {
    const V3d d = V3d(r.corner_) - V3d(p);
    x0 = d.dot(V3d(r.axis_u_));
    y0 = d.dot(V3d(r.axis_v_));
    z0 = -std::abs(d.dot(V3d(r.normal_)));
    x1 = x0 + r.length_u_;
    y1 = y0 + r.length_v_;
    // z components of the unit normals of the four planes through p and an edge; normals of
    // neighbouring planes are orthogonal in their other components.
    const double n0 = -y0 / std::hypot(z0, y0), n1 = x1 / std::hypot(z0, x1);
    const double n2 = y1 / std::hypot(z0, y1), n3 = -x0 / std::hypot(z0, x0);
    const auto angle = [](double a, double b) { return std::acos(std::clamp(-a * b, -1.0, 1.0)); };
    const double g0 = angle(n0, n1), g1 = angle(n1, n2), g2 = angle(n2, n3), g3 = angle(n3, n0);
    b0 = n0;
    b1 = n2;
    k = 2.0 * 3.14159265358979323846 - g2 - g3;
    solid_angle = g0 + g1 - k;
  }
  bool usable() const { return z0 < 0.0 && solid_angle > kSmallestSolidAngle; }

  // Coordinates in the plane of a point chosen uniformly in solid angle.
  std::pair<double, double> sample(const V2f& u) const {
    const double au = u.x * solid_angle + k;
    const double fu = (std::cos(au) * b0 - b1) / std::sin(au);
    const double cu = std::clamp(std::copysign(1.0, fu) / std::sqrt(fu * fu + b0 * b0), -1.0, 1.0);
    const double xu = std::clamp(-(cu * z0) / std::sqrt(std::max(1e-300, 1.0 - cu * cu)), x0, x1);
    const double d2 = xu * xu + z0 * z0;
    const double h0 = y0 / std::sqrt(d2 + y0 * y0), h1 = y1 / std::sqrt(d2 + y1 * y1);
    const double hv = h0 + u.y * (h1 - h0), hv2 = hv * hv;
    const double yv = hv2 < 1.0 - 1e-9 ? hv * std::sqrt(d2) / std::sqrt(1.0 - hv2) : y1;
    return {xu, std::clamp(yv, y0, y1)};
  }
};

Rectangle::Rectangle(const RectangleLight& light)
    : corner_(light.corner),
      edge_u_(light.edge_u),
      edge_v_(light.edge_v),
      radiance_(light.radiance) {
  const V3f c = cross(edge_u_, edge_v_);
  area_ = std::sqrt(dot(c, c));
  if (!is_finite(corner_) || !is_finite(edge_u_) || !is_finite(edge_v_) || !(area_ > 0.0f) ||
      !std::isfinite(area_))
    throw std::invalid_argument(fmt::format(
        "rectangle light '{}': corner and edges must be finite and span an area", light.name));
  normal_ = c / area_;
  axis_u_ = normalize(edge_u_);
  axis_v_ = normalize(edge_v_);
  length_u_ = std::sqrt(dot(edge_u_, edge_u_));
  length_v_ = std::sqrt(dot(edge_v_, edge_v_));
  right_angled_ = std::abs(dot(axis_u_, axis_v_)) < 1e-5f;
  power_ = luminance(radiance_) * area_;
}

LightSample Rectangle::sample(const V3f& p, const V2f& u) const {
  LightSample s;
  if (dot(p - corner_, normal_) <= 0.0f) return s;
  V3f point;
  bool by_solid_angle = false;
  if (right_angled_) {
    const SphericalRectangle seen(*this, p);
    if (seen.usable()) {
      by_solid_angle = true;
      const auto [x, y] = seen.sample(u);
      point = corner_ + axis_u_ * static_cast<float>(x - seen.x0) +
              axis_v_ * static_cast<float>(y - seen.y0);
      s.pdf = static_cast<float>(1.0 / seen.solid_angle);
    }
  }
  if (!by_solid_angle) point = corner_ + edge_u_ * u.x + edge_v_ * u.y;
  const V3f to_light = point - p;
  const float distance2 = dot(to_light, to_light);
  s.distance = std::sqrt(distance2);
  s.wi = to_light / s.distance;
  const float cosine = -dot(s.wi, normal_);
  if (!(distance2 > 0.0f) || !(cosine > 0.0f)) return {};
  if (!by_solid_angle) s.pdf = distance2 / (cosine * area_);
  s.radiance = radiance_;
  return s;
}

float Rectangle::pdf(const V3f& p, const V3f& wi, float distance) const {
  const float cosine = -dot(wi, normal_);
  if (!(cosine > 0.0f) || dot(p - corner_, normal_) <= 0.0f) return 0.0f;
  if (right_angled_) {
    const SphericalRectangle seen(*this, p);
    if (seen.usable()) return static_cast<float>(1.0 / seen.solid_angle);
  }
  return distance * distance / (cosine * area_);
}

float Rectangle::importance(const V3f& p) const {
  const float height = dot(p - corner_, normal_);
  if (height <= 0.0f) return 0.0f;
  const V3f d = p - (corner_ + (edge_u_ + edge_v_) * 0.5f);
  const float distance2 = dot(d, d);
  // A lower bound on the cosine, since the nearer end of a large light is seen less slanted.
  const float cosine = std::max(height / std::sqrt(distance2), 0.05f);
  return power_ * cosine / (distance2 + 0.25f * area_);
}

LightBounds Rectangle::bounds() const {
  LightBounds b;
  for (const V3f& corner :
       {corner_, corner_ + edge_u_, corner_ + edge_v_, corner_ + edge_u_ + edge_v_})
    for (int i = 0; i < 3; ++i) {
      b.low[i] = std::min(b.low[i], corner[i]);
      b.high[i] = std::max(b.high[i], corner[i]);
    }
  b.axis = normal_;
  b.spread = 0.0f;
  b.power = power_;
  return b;
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "tests/hypertexture_geom/ball_geometry.h"

namespace morsel::geom::test {

// A point on an edge of a brick where the surface crosses it (or, for `face`, on a line across a
// face): the place where neighbouring bricks must not leave a gap. None if a random one has none.
inline std::optional<Imath::V3d> surface_on_edge(const HypertextureGeometry& geometry,
                                                 const BallField& ball, std::mt19937& random,
                                                 bool face) {
  std::uniform_int_distribution<std::uint32_t> pick(
      0, static_cast<std::uint32_t>(geometry.statistics().bricks) - 1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const topology::Box box = geometry.brick_bounds(pick(random));
  const int axis = static_cast<int>(random() % 3);
  Imath::V3d a, b;
  for (int k = 0; k < 3; ++k) a[k] = b[k] = unit(random) < 0.5 ? box.min[k] : box.max[k];
  const int other = (axis + 1) % 3;
  if (face) a[other] = b[other] = box.min[other] + unit(random) * (box.max[other] - box.min[other]);
  a[axis] = box.min[axis];
  b[axis] = box.max[axis];
  const bool inside = ball.value(a) > 0.0;
  if (inside == (ball.value(b) > 0.0)) return std::nullopt;
  for (int k = 0; k < 60; ++k) {
    const Imath::V3d m = (a + b) * 0.5;
    ((ball.value(m) > 0.0) == inside ? a : b) = m;
  }
  return a;
}

// Rays aimed at such points, from the ball's centre (distance 0) or from `distance` outside.
inline void expect_watertight(const HypertextureGeometry& geometry, const BallField& ball,
                              const EmbreeScene& scene, double distance, int rays,
                              unsigned seed = 11) {
  std::mt19937 random(seed);
  int missed = 0;
  for (int i = 0; i < rays;) {
    const auto p = surface_on_edge(geometry, ball, random, i % 2 == 1);
    if (!p) continue;
    const Imath::V3d c = ball.centre(), outward = (*p - c).normalized();
    const Imath::V3d w(random_direction(random));
    if (w.dot(outward) < 0.1) continue;
    ++i;
    const Imath::V3f o(distance > 0.0 ? *p + w * distance : c);
    const Imath::V3f d(*p - Imath::V3d(o));
    const auto crossings = ball.crossings(Imath::V3d(o), Imath::V3d(d));
    if (!crossings) continue;  // a grazing ray that float coordinates moved off the ball
    const double t = distance > 0.0 ? crossings->first : crossings->second;
    const RTCRayHit h = scene.intersect(ray_of(o, d));
    // A gap lets the ray through to the far side, or out.
    if (!is_hit(h) || std::abs(h.ray.tfar - t) * d.length() > 1e-5 + 1e-6 * distance) ++missed;
    EXPECT_EQ(scene.occluded(ray_of(o, d)), is_hit(h));
  }
  EXPECT_EQ(missed, 0) << "of " << rays << " at distance " << distance;
}

}  // namespace morsel::geom::test

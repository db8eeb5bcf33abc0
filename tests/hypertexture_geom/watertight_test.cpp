// SPDX-License-Identifier: Apache-2.0
// No ray slips between bricks, and none that starts at a spawn point meets the surface it left.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "hypertexture_geom/embree/geometry.h"
#include "tests/hypertexture_geom/ball_geometry.h"

namespace morsel::geom {
namespace {

using test::random_direction;
using test::random_point;
using test::ray_of;

class WatertightTest : public test::BallGeometryTest {};

// A point on an edge of a brick where the surface crosses it (or, for `face`, on a line across a
// face): the place where neighbouring bricks must not leave a gap. None if a random one has none.
std::optional<Imath::V3d> surface_on_edge(const HypertextureGeometry& geometry,
                                          const test::BallField& ball, std::mt19937& random,
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
void expect_watertight(const HypertextureGeometry& geometry, const test::BallField& ball,
                       const test::EmbreeScene& scene, double distance, int rays) {
  std::mt19937 random(11);
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
    if (!test::is_hit(h) || std::abs(h.ray.tfar - t) * d.length() > 1e-5 + 1e-6 * distance)
      ++missed;
    EXPECT_EQ(scene.occluded(ray_of(o, d)), test::is_hit(h));
  }
  EXPECT_EQ(missed, 0) << "of " << rays << " at distance " << distance;
}

TEST_F(WatertightTest, FromWithin) { expect_watertight(*geometry_, *ball_, scene_, 0.0, 30000); }
TEST_F(WatertightTest, Nearby) { expect_watertight(*geometry_, *ball_, scene_, 3.0, 30000); }

TEST_F(WatertightTest, FromAThousandDiametersAway) {
  expect_watertight(*geometry_, *ball_, scene_, 1600.0, 30000);
}

TEST(WatertightOffsetTest, AThousandDiametersFromTheOrigin) {
  const auto ball = std::make_shared<test::BallField>(Imath::V3d(1600.1, -1599.7, 1600.3), 0.8);
  topology::CertifyOptions options;
  options.box =
      topology::dyadic_box({ball->centre() - Imath::V3d(1.0), ball->centre() + Imath::V3d(1.0)});
  options.min_depth = 5;
  const HypertextureGeometry geometry(ball, test::certified_cache(*ball, options), {});
  test::EmbreeScene scene;
  scene.attach(geometry.create(scene.device()));
  scene.commit();
  expect_watertight(geometry, *ball, scene, 0.0, 20000);
  expect_watertight(geometry, *ball, scene, 3.0, 20000);
}

TEST_F(WatertightTest, SpawnPointsHaveTheirSigns) {
  std::mt19937 random(13);
  int hits = 0;
  for (int i = 0; i < 10000; ++i) {
    const Imath::V3f o = random_point(random, 1.5f), d = random_direction(random);
    const RTCRayHit h = scene_.intersect(ray_of(o, d));
    if (!test::is_hit(h)) continue;
    ++hits;
    const Imath::V3f p = o + d * h.ray.tfar;
    const ShadingPoint s = geometry_->shade(h.hit.primID, p);
    EXPECT_TRUE(s.spawn_verified);
    EXPECT_LT(ball_->value(Imath::V3d(s.spawn_front)), 0.0);
    EXPECT_GT(ball_->value(Imath::V3d(s.spawn_behind)), 0.0);
    EXPECT_LT((s.spawn_front - p).length(), 1e-5f);
    EXPECT_LT((s.spawn_behind - p).length(), 1e-5f);
    EXPECT_NEAR(s.normal.length(), 1.0f, 1e-6f);
    EXPECT_LT((Imath::V3d(s.normal) - (Imath::V3d(p) - ball_->centre()).normalized()).length(),
              1e-5);
    EXPECT_EQ(s.component, geometry_->main_component());
    // Into the outer half-space nothing is in the way; into the ball the far side is.
    Imath::V3f w = random_direction(random);
    if (w.dot(s.normal) < 0.0f) w = -w;
    EXPECT_FALSE(scene_.occluded(ray_of(s.spawn_front, w)));
    EXPECT_TRUE(scene_.occluded(ray_of(s.spawn_behind, -w)));
  }
  EXPECT_GT(hits, 1000);
}

TEST_F(WatertightTest, SpawnOffsetCoversExtraError) {
  const Imath::V3f p(0.9f, -0.05f, 0.02f);
  std::uint32_t brick = 0;
  for (std::uint32_t i = 0; i < geometry_->statistics().bricks; ++i)
    if (geometry_->brick_bounds(i).intersects(Imath::V3d(p))) brick = i;
  const ShadingPoint s = geometry_->shade(brick, p, 1e-3f);
  EXPECT_GE((s.spawn_front - p).length(), 1e-3f);
  EXPECT_LT((s.spawn_front - p).length(), 1e-2f);
  EXPECT_TRUE(s.spawn_verified);
}

}  // namespace
}  // namespace morsel::geom

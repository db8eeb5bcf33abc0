// SPDX-License-Identifier: Apache-2.0
// No ray slips between bricks, and none that starts at a spawn point meets the surface it left.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "hypertexture_geom/embree/geometry.h"
#include "tests/hypertexture_geom/ball_geometry.h"
#include "tests/hypertexture_geom/watertight.h"

namespace morsel::geom {
namespace {

using test::random_direction;
using test::random_point;
using test::ray_of;

using test::expect_watertight;

class WatertightTest : public test::BallGeometryTest {};

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

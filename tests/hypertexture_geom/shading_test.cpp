// SPDX-License-Identifier: Apache-2.0
// What a hit says of itself: position and its error, the parts of the field, curvature.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "tests/hypertexture_geom/ball_geometry.h"
#include "tests/hypertexture_geom/eq13.h"

namespace morsel::geom {
namespace {

using test::random_direction;
using test::random_point;
using test::ray_of;

class ShadingTest : public test::BallGeometryTest {};

TEST_F(ShadingTest, PositionErrorHoldsOnABall) {
  std::mt19937 random(21);
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const Imath::V3f d = random_direction(random);
    const float distance = i % 2 ? 3.0f : 300.0f;
    const Imath::V3f o = random_point(random, 0.7f) - d * distance;
    const RTCRayHit h = scene_.intersect(ray_of(o, d));
    if (!test::is_hit(h)) continue;
    ++hits;
    // The rounding of t and of the point's sum.
    const float extra = 2.0f * distance * 0x1p-23f;
    const ShadingPoint s = geometry_->shade(h.hit.primID, o + d * h.ray.tfar, extra);
    ASSERT_TRUE(s.spawn_verified);
    const double off = std::abs((s.position - ball_->centre()).length() - ball_->radius());
    EXPECT_LE(off, s.position_error);
    // The Newton step makes it far better than what is guaranteed.
    EXPECT_LT(off, 1e-9);
    EXPECT_LT(s.position_error, 64.0 * (0x1p-23 + static_cast<double>(extra)));
  }
  EXPECT_GT(hits, 3000);
}

TEST_F(ShadingTest, DetailOnABall) {
  std::mt19937 random(22);
  for (int i = 0; i < 200; ++i) {
    const Imath::V3d n = Imath::V3d(random_direction(random)).normalized();
    const Imath::V3d x = ball_->centre() + n * ball_->radius();
    const auto brick = static_cast<std::uint32_t>(random() % geometry_->statistics().bricks);
    const SurfaceDetail d = geometry_->detail(brick, x);
    EXPECT_NEAR(d.curvature.mean, 1.0 / 0.8, 1e-12);
    EXPECT_NEAR(d.curvature.gaussian, 1.0 / 0.64, 1e-12);
    EXPECT_LT((d.gradient + n).length(), 1e-12);
    EXPECT_EQ(d.reference, x);
    EXPECT_EQ(d.noise, 0.0);
    EXPECT_EQ(d.component, geometry_->main_component());
  }
}

// Equation (13): D is a sphere in closed form, and on the surface the noise is what makes up for
// it.
TEST(ShadingPartsTest, DensityAndNoiseOfARock) {
  const Hypertexture rock = test::eq13(1);
  const auto cache = std::make_shared<topology::TopologyCache>(build_cache(rock));
  const HypertextureGeometry geometry(rock.field, cache,
                                      {.keep = topology::KeepRule::parse("all")});
  const auto sphere =
      field_from_json({{"density", {{"type", "sphere"}, {"radius", 1}}}}, {"s", ""});
  test::EmbreeScene scene;
  scene.attach(geometry.create(scene.device()));
  scene.commit();
  std::mt19937 random(23);
  int hits = 0, detached = 0;
  double most_noise = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const Imath::V3f d = random_direction(random), o = random_point(random, 1.0f) - d * 5.0f;
    const RTCRayHit h = scene.intersect(ray_of(o, d));
    if (!test::is_hit(h)) continue;
    ++hits;
    const ShadingPoint s = geometry.shade(h.hit.primID, o + d * h.ray.tfar);
    const SurfaceDetail detail = geometry.detail(h.hit.primID, s.position);
    EXPECT_DOUBLE_EQ(detail.density, sphere->value(s.position));
    EXPECT_NEAR(detail.density + detail.noise, rock.field->value(s.position), 1e-15);
    EXPECT_NEAR(detail.density + detail.noise, 0.0, 1e-9);
    EXPECT_EQ(detail.reference, s.position);
    EXPECT_EQ(detail.component, s.component);
    EXPECT_LT((Imath::V3d(s.normal) + detail.gradient.normalized()).length(), 1e-4);
    detached += detail.component != geometry.main_component();
    most_noise = std::max(most_noise, std::abs(detail.noise));
    // The component is that of the labelled octree, looked up independently just behind the hit.
    const topology::OctreeView octree = cache->topology.octree();
    if (s.spawn_verified) {
      const Imath::V3d inside(s.spawn_behind);
      EXPECT_EQ(octree.nodes[octree.locate(inside).node].component, s.component) << i;
    }
  }
  EXPECT_GT(hits, 2000);
  EXPECT_GT(detached, 20);
  EXPECT_GT(most_noise, 0.3);
}

TEST(FieldPartsTest, ReferenceGoesBackThroughWarps) {
  const nlohmann::json warp{{"type", "warp"}, {"amplitude", 0.2}, {"frequency", 2}, {"seed", 3}};
  const nlohmann::json fbm{{"type", "fbm"}, {"amplitude", 0.1}, {"frequency", 3}};
  const nlohmann::json sphere{{"type", "sphere"}, {"radius", 1}};
  const auto plain = field_from_json({{"density", sphere}}, {"", ""});
  const auto bumpy = field_from_json({{"density", sphere}, {"modulations", {fbm}}}, {"", ""});
  const auto warped = field_from_json({{"density", sphere}, {"modulations", {warp}}}, {"", ""});
  const auto both = field_from_json({{"density", sphere}, {"modulations", {fbm, warp}}}, {"", ""});
  const auto other = field_from_json({{"density", sphere}, {"modulations", {warp, fbm}}}, {"", ""});
  const auto twice =
      field_from_json({{"density", sphere}, {"modulations", {warp, fbm, warp}}}, {"", ""});
  std::mt19937 random(24);
  double moved = 0.0;
  for (int i = 0; i < 100; ++i) {
    const Imath::V3d x(random_point(random, 1.5f));
    const FieldParts w = warped->parts(x);
    EXPECT_DOUBLE_EQ(plain->value(w.reference), warped->value(x));
    EXPECT_DOUBLE_EQ(w.density, warped->value(x));
    EXPECT_EQ(w.noise, 0.0);
    moved = std::max(moved, (w.reference - x).length());
    // A warp on top moves the bumps with the sphere; one below does not.
    EXPECT_EQ(both->parts(x).reference, w.reference);
    EXPECT_DOUBLE_EQ(both->value(x), bumpy->value(w.reference));
    EXPECT_EQ(other->parts(x).reference, w.reference);
    EXPECT_NEAR(other->parts(x).noise, bumpy->value(x) - plain->value(x), 1e-14);
    EXPECT_EQ(twice->parts(x).reference, warped->parts(w.reference).reference);
    EXPECT_DOUBLE_EQ(twice->parts(x).density + twice->parts(x).noise, twice->value(x));
  }
  EXPECT_GT(moved, 0.05);
}

}  // namespace
}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
// The user geometry as Embree sees it, on a ball whose answers are known in closed form. Named
// after the tests of Embree's own user geometries.
#include "hypertexture_geom/embree/geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <set>

#include "tests/hypertexture_geom/ball_geometry.h"

namespace morsel::geom {
namespace {

using test::random_direction;
using test::random_point;
using test::ray_of;

class GeometryTest : public test::BallGeometryTest {};

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST_F(GeometryTest, HasBricksOfOneComponent) {
  EXPECT_GT(geometry_->statistics().bricks, 100u);
  EXPECT_EQ(geometry_->statistics().limits, 0u);
  EXPECT_EQ(geometry_->main_component(), geometry_->component(0));
  EXPECT_LE(geometry_->statistics().bytes, geometry_->statistics().bricks * 240);
}

TEST_F(GeometryTest, HitsTheBallFromOutsideAndInside) {
  std::mt19937 random(1);
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Imath::V3f o = random_point(random, 1.5f);
    const float length = std::exp2(std::uniform_real_distribution<float>(-6.0f, 6.0f)(random));
    const Imath::V3f d = random_direction(random) * length;
    const auto expected = ball_->crossings(Imath::V3d(o), Imath::V3d(d));
    const RTCRayHit h = scene_.intersect(ray_of(o, d));
    double t = -1.0;
    if (expected) t = expected->first > 0.0 ? expected->first : expected->second;
    ASSERT_EQ(test::is_hit(h), t > 0.0) << i;
    ASSERT_EQ(scene_.occluded(ray_of(o, d)), t > 0.0) << i;
    if (!(t > 0.0)) continue;
    ++hits;
    EXPECT_NEAR(h.ray.tfar * length, t * length, 1e-6) << i;
    EXPECT_EQ(h.hit.geomID, id_);
    EXPECT_LT(h.hit.primID, geometry_->statistics().bricks);
    EXPECT_EQ(h.hit.instID[0], RTC_INVALID_GEOMETRY_ID);
    const Imath::V3d outward = (Imath::V3d(o) + Imath::V3d(d) * t - ball_->centre()).normalized();
    const Imath::V3f ng(h.hit.Ng_x, h.hit.Ng_y, h.hit.Ng_z);
    EXPECT_LT((Imath::V3d(ng).normalized() - outward).length(), 1e-5) << i;
  }
  EXPECT_GT(hits, 3000);
}

TEST_F(GeometryTest, AxisParallelRays) {
  std::mt19937 random(2);
  for (int i = 0; i < 6000; ++i) {
    const int axis = i % 3;
    Imath::V3f o = random_point(random, 0.9f), d(0.0f);
    d[axis] = i % 2 ? 3.0f : -0.25f;
    if (i % 4 < 2) d[(axis + 1) % 3] = -0.0f;
    if (i % 5) o[axis] = -4.0f * d[axis] / std::abs(d[axis]);
    // On planes between bricks as well.
    if (i % 7 == 0) o[(axis + 1) % 3] = std::round(o[(axis + 1) % 3] * 16.0f) / 16.0f;
    if (i % 14 == 0) o[(axis + 2) % 3] = std::round(o[(axis + 2) % 3] * 16.0f) / 16.0f;
    const auto expected = ball_->crossings(Imath::V3d(o), Imath::V3d(d));
    double t = -1.0;
    if (expected) t = expected->first > 0.0 ? expected->first : expected->second;
    const RTCRayHit h = scene_.intersect(ray_of(o, d));
    ASSERT_EQ(test::is_hit(h), t > 0.0) << i;
    if (t > 0.0) {
      EXPECT_NEAR(h.ray.tfar, t, 2e-6 * std::max(1.0, t)) << i;
    }
  }
}

TEST_F(GeometryTest, RespectsTnearAndTfar) {
  const Imath::V3f o(-3.0f, 0.0f, 0.0f), d(1.0f, 0.0f, 0.0f);
  const auto [t0, t1] = *ball_->crossings(Imath::V3d(o), Imath::V3d(d));
  const auto a = static_cast<float>(t0), b = static_cast<float>(t1);
  const float e = 1e-5f;
  const auto hit_at = [&](float tnear, float tfar) {
    const RTCRayHit h = scene_.intersect(ray_of(o, d, tnear, tfar));
    EXPECT_EQ(scene_.occluded(ray_of(o, d, tnear, tfar)), test::is_hit(h)) << tnear << " " << tfar;
    return test::is_hit(h) ? h.ray.tfar : -1.0f;
  };
  EXPECT_NEAR(hit_at(0.0f, kInfinity), a, 1e-6f);
  EXPECT_NEAR(hit_at(a - e, a + e), a, 1e-6f);
  EXPECT_EQ(hit_at(0.0f, a - e), -1.0f);
  EXPECT_NEAR(hit_at(a + e, kInfinity), b, 1e-6f);
  EXPECT_NEAR(hit_at(a + e, b + e), b, 1e-6f);
  EXPECT_EQ(hit_at(a + e, b - e), -1.0f);
  EXPECT_EQ(hit_at(b + e, kInfinity), -1.0f);
  EXPECT_EQ(hit_at(2.0f, 1.0f), -1.0f);
}

TEST_F(GeometryTest, BrickCallsTakeNegativeParameters) {
  // Embree itself refuses a negative tnear (it asserts); the pure function need not.
  const Imath::V3d o(3, 0, 0), d(1, 0, 0);
  double last = -10.0;
  for (std::uint32_t i = 0; i < geometry_->statistics().bricks; ++i)
    if (const auto hit = geometry_->intersect_brick(i, o, d, -10.0, 0.0))
      last = std::max(last, hit->t);
  EXPECT_NEAR(last, ball_->crossings(o, d)->second, 1e-7);
}

TEST_F(GeometryTest, StartingOnTheSurfaceIsNotAHit) {
  // A ball whose surface passes exactly through representable points.
  const auto unit = std::make_shared<test::BallField>(Imath::V3d(0.0), 0.5);
  topology::CertifyOptions options;
  options.box = topology::dyadic_box({Imath::V3d(-1.0), Imath::V3d(1.0)});
  options.min_depth = 4;
  const HypertextureGeometry geometry(unit, test::certified_cache(*unit, options), {});
  test::EmbreeScene scene;
  scene.attach(geometry.create(scene.device()));
  scene.commit();
  ASSERT_EQ(unit->value({-0.5, 0, 0}), 0.0);
  EXPECT_FALSE(test::is_hit(scene.intersect(ray_of({-0.5f, 0, 0}, {-1, 0, 0}))));
  const RTCRayHit through = scene.intersect(ray_of({-0.5f, 0, 0}, {1, 0, 0}));
  ASSERT_TRUE(test::is_hit(through));
  EXPECT_NEAR(through.ray.tfar, 1.0f, 1e-6f);
}

TEST_F(GeometryTest, Nan) {
  for (int field = 0; field < 8; ++field) {
    RTCRay ray = ray_of({-3, 0, 0}, {1, 0, 0});
    float* values[] = {&ray.org_x, &ray.org_y, &ray.org_z, &ray.dir_x,
                       &ray.dir_y, &ray.dir_z, &ray.tnear, &ray.tfar};
    *values[field] = kNan;
    const RTCRayHit h = scene_.intersect(ray);
    EXPECT_FALSE(test::is_hit(h)) << field;
    scene_.occluded(ray);
  }
}

TEST_F(GeometryTest, Infinity) {
  for (const float sign : {1.0f, -1.0f})
    for (int field = 0; field < 6; ++field) {
      RTCRay ray = ray_of({-3, 0, 0}, {1, 0, 0});
      float* values[] = {&ray.org_x, &ray.org_y, &ray.org_z, &ray.dir_x, &ray.dir_y, &ray.dir_z};
      *values[field] = sign * kInfinity;
      EXPECT_FALSE(test::is_hit(scene_.intersect(ray))) << field;
      EXPECT_FALSE(scene_.occluded(ray)) << field;
    }
  EXPECT_FALSE(test::is_hit(scene_.intersect(ray_of({-3, 0, 0}, {0, 0, 0}))));
}

TEST_F(GeometryTest, BrickCallsRefuseBadRays) {
  const auto bad = [&](const Imath::V3d& o, const Imath::V3d& d, double tnear, double tfar) {
    for (std::uint32_t i = 0; i < 50; ++i)
      if (geometry_->intersect_brick(i, o, d, tnear, tfar)) return false;
    return true;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(bad({nan, 0, 0}, {1, 0, 0}, 0, inf));
  EXPECT_TRUE(bad({0, 0, 0}, {1, nan, 0}, 0, inf));
  EXPECT_TRUE(bad({0, inf, 0}, {1, 0, 0}, 0, inf));
  EXPECT_TRUE(bad({0, inf, 0}, {1, -inf, 0}, 0, inf));
  EXPECT_TRUE(bad({0, 0, 0}, {1, 0, 0}, nan, inf));
  EXPECT_TRUE(bad({0, 0, 0}, {1, 0, 0}, 0, nan));
  EXPECT_TRUE(bad(topology::centre(geometry_->brick_bounds(0)), {0, 0, 0}, -inf, inf));
}

TEST_F(GeometryTest, InactiveRays) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 500; ++trial) {
    RTCRayHit8 packet;
    std::memset(&packet, 0, sizeof packet);
    RTCRay8 shadow;
    int valid[8];
    RTCRayHit single[8];
    for (int i = 0; i < 8; ++i) {
      valid[i] = random() % 2 ? -1 : 0;
      const RTCRay ray = ray_of(random_point(random, 1.5f), random_direction(random));
      single[i] = make_ray_hit(ray);
      packet.ray.org_x[i] = ray.org_x;
      packet.ray.org_y[i] = ray.org_y;
      packet.ray.org_z[i] = ray.org_z;
      packet.ray.dir_x[i] = ray.dir_x;
      packet.ray.dir_y[i] = ray.dir_y;
      packet.ray.dir_z[i] = ray.dir_z;
      packet.ray.tnear[i] = ray.tnear;
      packet.ray.tfar[i] = ray.tfar;
      packet.ray.time[i] = 0.0f;
      packet.ray.mask[i] = ray.mask;
      packet.ray.flags[i] = 0;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    shadow = packet.ray;
    intersect_packet(valid, scene_.scene(), packet);
    occluded_packet(valid, scene_.scene(), shadow);
    for (int i = 0; i < 8; ++i) {
      if (valid[i] == 0) {
        EXPECT_EQ(packet.hit.geomID[i], RTC_INVALID_GEOMETRY_ID);
        EXPECT_EQ(packet.ray.tfar[i], kInfinity);
        EXPECT_EQ(shadow.tfar[i], kInfinity);
        continue;
      }
      intersect1(scene_.scene(), single[i]);
      ASSERT_EQ(packet.hit.geomID[i], single[i].hit.geomID) << trial << " " << i;
      EXPECT_EQ(shadow.tfar[i] < 0.0f, test::is_hit(single[i]));
      if (!test::is_hit(single[i])) continue;
      EXPECT_NEAR(packet.ray.tfar[i], single[i].ray.tfar, 1e-6f);
      EXPECT_NEAR(packet.hit.Ng_x[i], single[i].hit.Ng_x, 1e-5f);
    }
  }
}

// What a ray origin or a spawn point is tested with must be what Embree will see. See
// cmake/MorselCompiler.cmake.
[[gnu::noinline]] Imath::V3d through_float(const Imath::V3d& x) {
  return Imath::V3d(Imath::V3f(x));
}
TEST(Compiler, RoundTripThroughFloatRounds) {
  const Imath::V3d x(1603.1, -1599.7, 1600.3), y = through_float(x);
  for (int i = 0; i < 3; ++i) {
    volatile float rounded = static_cast<float>(x[i]);
    EXPECT_EQ(y[i], static_cast<double>(rounded));
  }
}

TEST(GeometryMaskTest, RayMasks) {
  const auto ball = std::make_shared<test::BallField>(Imath::V3d(0.0), 0.5);
  topology::CertifyOptions options;
  options.box = topology::dyadic_box({Imath::V3d(-1.0), Imath::V3d(1.0)});
  const HypertextureGeometry geometry(ball, test::certified_cache(*ball, options), {});
  test::EmbreeScene scene;
  if (!rtcGetDeviceProperty(scene.device(), RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED))
    GTEST_SKIP() << "this Embree was built without ray masks";
  RTCGeometry g = geometry.create(scene.device());
  rtcSetGeometryMask(g, 0b0110);
  rtcCommitGeometry(g);
  scene.attach(g);
  scene.commit();
  for (const unsigned mask : {0b0001u, 0b0010u, 0b0100u, 0b1000u, 0b1111u, 0u}) {
    RTCRay ray = ray_of({-3, 0, 0}, {1, 0, 0});
    ray.mask = mask;
    EXPECT_EQ(test::is_hit(scene.intersect(ray)), (mask & 0b0110u) != 0) << mask;
    EXPECT_EQ(scene.occluded(ray), (mask & 0b0110u) != 0) << mask;
  }
}

TEST_F(GeometryTest, GetBounds) {
  RTCBounds b;
  rtcGetSceneBounds(scene_.scene(), &b);
  const topology::Box bricks = geometry_->bounds();
  const auto pad = static_cast<float>(2.0 * geometry_->bounds_padding());
  for (int i = 0; i < 3; ++i) {
    const double surface_lo = ball_->centre()[i] - ball_->radius();
    const double surface_hi = ball_->centre()[i] + ball_->radius();
    EXPECT_LE(bricks.min[i], surface_lo);
    EXPECT_GE(bricks.max[i], surface_hi);
    EXPECT_GE(bricks.min[i], surface_lo - 2.0 / 32);  // one cell at the depth asked for
    EXPECT_LE(bricks.max[i], surface_hi + 2.0 / 32);
  }
  EXPECT_LE(b.lower_x, bricks.min.x);
  EXPECT_GE(b.upper_z, bricks.max.z);
  EXPECT_GE(b.lower_x, static_cast<float>(bricks.min.x) - pad);
  EXPECT_LE(b.upper_z, static_cast<float>(bricks.max.z) + pad);
}

TEST_F(GeometryTest, Instancing) {
  test::EmbreeScene world;
  test::EmbreeScene* object = &world;  // one device for both scenes
  RTCScene inner = rtcNewScene(object->device());
  RTCGeometry g = geometry_->create(object->device());
  rtcAttachGeometryByID(inner, g, 5);
  rtcReleaseGeometry(g);
  rtcCommitScene(inner);
  Imath::M44f m[2];
  m[0].setScale(Imath::V3f(2.0f, 0.5f, 1.0f));
  m[0][3][0] = 4.0f;
  m[1].setEulerAngles(Imath::V3f(0.3f, 0.7f, -0.2f));
  m[1][3][0] = -4.0f;
  const unsigned ids[2] = {world.attach_instance(inner, m[0]), world.attach_instance(inner, m[1])};
  world.commit();
  std::mt19937 random(5);
  int hits = 0;
  for (int i = 0; i < 4000; ++i) {
    const int k = i % 2;
    const Imath::V3f target = Imath::V3f(ball_->centre()) + random_point(random, 0.7f);
    Imath::V3f world_target;
    m[k].multVecMatrix(target, world_target);
    const Imath::V3f o = world_target + random_direction(random) * 3.0f;
    const Imath::V3f d = (world_target - o) * 0.25f;
    // Both instances may be in the way: the nearer wins.
    double best = std::numeric_limits<double>::infinity();
    unsigned best_id = RTC_INVALID_GEOMETRY_ID;
    for (int j = 0; j < 2; ++j) {
      Imath::V3d lo, ld;
      const Imath::M44d inverse = Imath::M44d(m[j]).inverse();
      inverse.multVecMatrix(Imath::V3d(o), lo);
      inverse.multDirMatrix(Imath::V3d(d), ld);
      const auto c = ball_->crossings(lo, ld);
      if (!c) continue;
      const double t = c->first > 0.0 ? c->first : c->second;
      if (t > 0.0 && t < best) best = t, best_id = ids[j];
    }
    const RTCRayHit h = world.intersect(ray_of(o, d));
    ASSERT_EQ(test::is_hit(h), best_id != RTC_INVALID_GEOMETRY_ID) << i;
    if (!test::is_hit(h)) continue;
    ++hits;
    EXPECT_EQ(h.hit.instID[0], best_id);
    EXPECT_EQ(h.hit.geomID, 5u);
    EXPECT_NEAR(h.ray.tfar, best, 2e-5) << i;
    EXPECT_TRUE(world.occluded(ray_of(o, d)));
  }
  EXPECT_GT(hits, 2000);
  rtcReleaseScene(inner);
}

struct FilterLog {
  std::vector<float> t;
  std::size_t accept_from = 0;  // how many hits to reject first
  static FilterLog current;
  static void run(const RTCFilterFunctionNArguments* a) {
    ASSERT_EQ(a->N, 1u);
    current.t.push_back(RTCRayN_tfar(a->ray, 1, 0));
    EXPECT_NE(RTCHitN_Ng_x(a->hit, 1, 0), 0.0f);
    EXPECT_NE(RTCHitN_primID(a->hit, 1, 0), RTC_INVALID_GEOMETRY_ID);
    if (current.t.size() <= current.accept_from) a->valid[0] = 0;
  }
};
FilterLog FilterLog::current;

TEST_F(GeometryTest, IntersectionFilter) {
  test::EmbreeScene scene;
  RTCGeometry g = geometry_->create(scene.device(), {.occlusion_filter = true});
  rtcSetGeometryIntersectFilterFunction(g, FilterLog::run);
  rtcSetGeometryOccludedFilterFunction(g, FilterLog::run);
  rtcCommitGeometry(g);
  scene.attach(g);
  scene.commit();
  const Imath::V3f o(-3.0f, 0.011f, 0.023f), d(1.0f, 0.0f, 0.0f);
  const auto [t0, t1] = *ball_->crossings(Imath::V3d(o), Imath::V3d(d));
  const auto run = [&](std::size_t reject, bool occluded) {
    FilterLog& log = FilterLog::current;
    log = {{}, reject};
    if (occluded) return std::pair(scene.occluded(ray_of(o, d)) ? 0.0f : -1.0f, log.t);
    const RTCRayHit h = scene.intersect(ray_of(o, d));
    return std::pair(test::is_hit(h) ? h.ray.tfar : -1.0f, log.t);
  };
  EXPECT_NEAR(run(0, false).first, t0, 1e-6);
  EXPECT_NEAR(run(1, false).first, t1, 1e-6);
  EXPECT_EQ(run(2, false).first, -1.0f);
  EXPECT_EQ(run(2, false).second.size(), 2u);  // each root is offered once
  EXPECT_EQ(run(0, true).first, 0.0f);
  EXPECT_EQ(run(1, true).first, 0.0f);
  EXPECT_EQ(run(2, true).first, -1.0f);
  EXPECT_EQ(run(2, true).second.size(), 2u);
}

TEST(GeometryFilterTest, OffersBothRootsOfOneBrick) {
  // A ball so small that a brick holds all of its chord.
  const auto ball = std::make_shared<test::BallField>(Imath::V3d(0.3), 0.05);
  topology::CertifyOptions options;
  options.box = topology::dyadic_box({Imath::V3d(0.0), Imath::V3d(1.0)});
  const HypertextureGeometry geometry(ball, test::certified_cache(*ball, options), {});
  const Imath::V3d o(-1.0, 0.29, 0.345), d(1, 0, 0);
  const auto [t0, t1] = *ball->crossings(o, d);
  std::set<double> found;
  for (std::uint32_t i = 0; i < geometry.statistics().bricks; ++i) {
    double tnear = 0.0;
    while (const auto hit = geometry.intersect_brick(i, o, d, tnear, 1e9)) {
      found.insert(hit->t);
      tnear = hit->t + 1e-7;
    }
  }
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(*found.begin(), t0, 1e-8);
  EXPECT_NEAR(*found.rbegin(), t1, 1e-8);
}

TEST_F(GeometryTest, EnableDisable) {
  rtcDisableGeometry(rtcGetGeometry(scene_.scene(), id_));
  rtcCommitScene(scene_.scene());
  EXPECT_FALSE(test::is_hit(scene_.intersect(ray_of({-3, 0, 0}, {1, 0, 0}))));
  rtcEnableGeometry(rtcGetGeometry(scene_.scene(), id_));
  rtcCommitScene(scene_.scene());
  EXPECT_TRUE(test::is_hit(scene_.intersect(ray_of({-3, 0, 0}, {1, 0, 0}))));
}

TEST(GeometryKeepTest, NothingKeptIsEmptyAndLegal) {
  const auto ball = std::make_shared<test::BallField>(Imath::V3d(0.0), 0.5);
  topology::CertifyOptions options;
  options.box = topology::dyadic_box({Imath::V3d(-1.0), Imath::V3d(1.0)});
  const HypertextureGeometry geometry(ball, test::certified_cache(*ball, options),
                                      {.keep = topology::KeepRule::parse("detached")});
  EXPECT_EQ(geometry.statistics().bricks, 0u);
  EXPECT_TRUE(geometry.bounds().isEmpty());
  test::EmbreeScene scene;
  scene.attach(geometry.create(scene.device()));
  scene.commit();
  EXPECT_FALSE(test::is_hit(scene.intersect(ray_of({-3, 0, 0}, {1, 0, 0}))));
}

}  // namespace
}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
// All hits, first hit and any hit of one geometry.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <thread>

#include "hypertexture_geom/embree/surface_query.h"
#include "tests/hypertexture_geom/ball_geometry.h"
#include "tests/hypertexture_geom/eq13.h"

namespace morsel::geom {
namespace {

using test::random_direction;
using test::random_point;

class SurfaceQueryTest : public test::BallGeometryTest {
 protected:
  SurfaceQuery query_{*geometry_, scene_.device()};
};

TEST_F(SurfaceQueryTest, BothCrossingsOfABall) {
  std::mt19937 random(31);
  int both = 0;
  for (int i = 0; i < 10000; ++i) {
    Imath::V3f o = random_point(random, 1.2f), d = random_direction(random) * 2.5f;
    if (i % 3 == 0) {  // along brick faces, and edges
      d = {0.0f, 0.0f, 0.0f};
      d[i % 9 / 3] = -1.0f;
      for (int k = 0; k < 3; ++k) o[k] = std::round(o[k] * 16.0f) / 16.0f;
      o -= d * 3.0f;
    }
    const auto expected = ball_->crossings(Imath::V3d(o), Imath::V3d(d));
    std::vector<double> roots;
    if (expected)
      for (const double t : {expected->first, expected->second})
        if (t > 0.0) roots.push_back(t);
    const auto hits = query_.all_hits(o, d);
    ASSERT_EQ(hits.size(), roots.size()) << i;
    for (std::size_t k = 0; k < hits.size(); ++k) {
      EXPECT_NEAR(hits[k].t, roots[k], 1e-7);
      EXPECT_EQ(hits[k].entering, roots[k] == expected->first);
    }
    both += hits.size() == 2;
    const auto first = query_.first_hit(o, d);
    ASSERT_EQ(first.has_value(), !hits.empty());
    if (first) {
      EXPECT_NEAR(first->t, hits[0].t, 1e-7);  // found on another stretch of the ray
      EXPECT_EQ(first->entering, hits[0].entering);
    }
    EXPECT_EQ(query_.any_hit(o, d), !hits.empty());
  }
  EXPECT_GT(both, 1000);
}

// Not even where F is exactly zero, as it is here at the one place that is asked about.
TEST(SurfaceQuery, NothingIsHitOnIntervalsOfNoLength) {
  const auto ball = std::make_shared<test::BallField>(Imath::V3d(0.0), 0.5);
  ASSERT_EQ(ball->value(Imath::V3d(0.5, 0.0, 0.0)), 0.0);
  topology::CertifyOptions options;
  options.box = topology::dyadic_box({Imath::V3d(-1.0), Imath::V3d(1.0)});
  options.min_depth = 5;
  for (const Solver solver : {Solver::kModel, Solver::kSegment, Solver::kSphere}) {
    GeometryOptions with;
    with.solver = solver;
    const HypertextureGeometry geometry(ball, test::certified_cache(*ball, options), with);
    const test::EmbreeScene scene;
    const SurfaceQuery query(geometry, scene.device());
    for (const float t : {0.0f, 1.5f, 2.5f}) {
      const Imath::V3f origin(0.5f + (t == 2.5f ? 1.5f : t), 0.0f, 0.0f),
          direction(-1.0f, 0.0f, 0.0f);
      EXPECT_TRUE(query.all_hits(origin, direction, t, t).empty()) << t;
      EXPECT_FALSE(query.first_hit(origin, direction, t, t).has_value()) << t;
      EXPECT_FALSE(query.any_hit(origin, direction, t, t)) << t;
      EXPECT_EQ(query.all_hits(origin, direction, t).size(), t == 2.5f ? 0u : 1u) << t;
    }
  }
}

TEST_F(SurfaceQueryTest, IntervalIsRespected) {
  const Imath::V3f o(-3.0f, 0.0f, 0.0f), d(1.0f, 0.0f, 0.0f);
  const auto [t0, t1] = *ball_->crossings(Imath::V3d(o), Imath::V3d(d));
  const auto a = static_cast<float>(t0), b = static_cast<float>(t1);
  const float e = 1e-5f;
  EXPECT_EQ(query_.all_hits(o, d, a - e, b + e).size(), 2u);
  EXPECT_EQ(query_.all_hits(o, d, a + e, b + e).size(), 1u);
  EXPECT_EQ(query_.all_hits(o, d, a + e, b - e).size(), 0u);
  EXPECT_FALSE(query_.any_hit(o, d, a + e, b - e));
  EXPECT_FALSE(query_.first_hit(o, d, b + e).has_value());
  EXPECT_NEAR(query_.first_hit(o, d, a + e)->t, t1, 1e-7);
}

TEST_F(SurfaceQueryTest, RaysThatEmbreeRefusesHitNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(query_.all_hits({nan, 0, 0}, {1, 0, 0}).empty());
  EXPECT_TRUE(query_.all_hits({-3, 0, 0}, {nan, 0, 0}).empty());
  EXPECT_TRUE(query_.all_hits({-3, 0, 0}, {1, 0, 0}, -1.0f).empty());
  EXPECT_TRUE(query_.all_hits({0, 0, 0}, {0, 0, 0}).empty());
  EXPECT_FALSE(query_.any_hit({-3, 0, 0}, {nan, 0, 0}));
  EXPECT_FALSE(query_.first_hit({-3, nan, 0}, {1, 0, 0}).has_value());
}

// Against a march in steps of a thousandth: every change of sign that it sees, and no other but
// pairs that lie between two of its steps.
TEST(SurfaceQueryRockTest, AllHitsAgainstAMarch) {
  const Hypertexture rock = test::eq13(1);
  const auto cache = std::make_shared<topology::TopologyCache>(build_cache(rock));
  const HypertextureGeometry geometry(rock.field, cache,
                                      {.keep = topology::KeepRule::parse("all")});
  RTCDevice device = rtcNewDevice(nullptr);
  {
    const SurfaceQuery query(geometry, device);
    std::mt19937 random(32);
    int crossings = 0;
    for (int i = 0; i < 60; ++i) {
      const Imath::V3f d = random_direction(random), o = random_point(random, 1.0f) - d * 4.0f;
      const auto hits = query.all_hits(o, d);
      for (std::size_t k = 0; k < hits.size(); ++k) {
        EXPECT_EQ(hits[k].entering, k % 2 == 0) << i << " " << k;
        EXPECT_LE(std::abs(rock.field->value(Imath::V3d(o) + Imath::V3d(d) * hits[k].t)),
                  1.1 * geometry.tolerance() * hits[k].gradient.length());
      }
      EXPECT_EQ(hits.size() % 2, 0u) << i;
      std::size_t next = 0;
      bool inside = false;
      const double step = 1e-3;
      for (double t = 0.0; t < 8.0; t += step) {
        std::size_t count = 0;
        while (next < hits.size() && hits[next].t <= t) ++next, ++count;
        const bool now = rock.field->value(Imath::V3d(o) + Imath::V3d(d) * t) > 0.0;
        EXPECT_EQ(now != inside, count % 2 == 1) << "ray " << i << " at " << t;
        crossings += now != inside;
        inside = now;
      }
      EXPECT_EQ(next, hits.size());
    }
    EXPECT_GT(crossings, 200);
  }
  rtcReleaseDevice(device);
}

TEST_F(SurfaceQueryTest, FromManyThreads) {
  std::vector<std::thread> threads;
  std::vector<int> counts(4, 0);
  for (int k = 0; k < 4; ++k)
    threads.emplace_back([&, k] {
      for (int i = 0; i < 2000; ++i)
        counts[static_cast<std::size_t>(k)] += static_cast<int>(
            query_.all_hits({-3.0f, 0.0004f * static_cast<float>(i - 1000), 0.0f}, {1, 0, 0})
                .size());
    });
  for (std::thread& t : threads) t.join();
  for (const int count : counts) EXPECT_EQ(count, 4000);
}

}  // namespace
}  // namespace morsel::geom

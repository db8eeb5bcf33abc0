// SPDX-License-Identifier: Apache-2.0
// Where rays start again: on their side of the surface, and never behind another solid or gap.
#include "hypertexture_geom/embree/spawn.h"

#include <gtest/gtest.h>

#include "hypertexture_geom/embree/geometry.h"

namespace morsel::geom {
namespace {

// Along x, from the surface at 0 outward: a gap, then a second solid, then nothing.
struct Layers {
  double gap, solid;
  double operator()(const Imath::V3d& x) const {
    const double middle = gap + 0.5 * solid;
    return std::max(-x.x, 0.5 * solid - std::abs(x.x - middle));
  }
  // Whether no more than the first surface lies between the origin and p.
  bool single(const Imath::V3d& p) const { return p.x < gap; }
  SpawnPoint front(double offset) const {
    return spawn_point(Imath::V3d(0.0), {1.0, 0.0, 0.0}, offset, -1.0, *this,
                       [this](const Imath::V3d& p) { return single(p); });
  }
};

TEST(SpawnPoint, IsAtTheOffsetInTheOpen) {
  const SpawnPoint p = Layers{1.0, 1.0}.front(1e-3);
  EXPECT_TRUE(p.verified);
  EXPECT_EQ(p.point.x, 1e-3f);
}

TEST(SpawnPoint, IsInAGapThinnerThanTheOffset) {
  for (const double gap : {0.3e-3, 0.6e-3, 0.9e-3}) {
    const SpawnPoint p = Layers{gap, 0.05}.front(1e-3);
    EXPECT_TRUE(p.verified) << gap;
    EXPECT_GT(p.point.x, 0.0f) << gap;
    EXPECT_LT(p.point.x, static_cast<float>(gap)) << gap;
  }
}

// Doubling alone would end behind the second solid, and say that it is verified.
TEST(SpawnPoint, IsNeverBehindAnotherSolid) {
  const SpawnPoint p = Layers{0.1e-3, 0.05}.front(1e-3);
  EXPECT_FALSE(p.verified);
  EXPECT_LE(p.point.x, 1e-3f);
}

// x is farther inside than the offset says: the only surface is passed by doubling.
TEST(SpawnPoint, DoublesAsLongAsTheSurfaceIsSingle) {
  const auto value = [](const Imath::V3d& x) { return 0.01 - x.x; };
  const auto find = [&](bool single) {
    return spawn_point(Imath::V3d(0.0), {1.0, 0.0, 0.0}, 1e-3, -1.0, value,
                       [&](const Imath::V3d&) { return single; });
  };
  EXPECT_TRUE(find(true).verified);
  EXPECT_EQ(find(true).point.x, 16e-3f);
  EXPECT_FALSE(find(false).verified);
}

// Two balls side by side, a thousand units off, where float coordinates are 6e-5 apart.
TEST(SpawnPoint, BetweenBallsFarFromTheOrigin) {
  constexpr float kGap = 5e-4f;
  const auto json = nlohmann::json::parse(R"({"type": "hypertexture", "name": "balls",
    "keep": "all", "max_depth": 10,
    "bounds": {"min": [999, -1, -1], "max": [1003, 1, 1]},
    "field": {"density": {"type": "union", "width": 1e-5, "densities": [
      {"type": "sphere", "radius": 0.5, "center": [1000, 0, 0]},
      {"type": "sphere", "radius": 0.5, "center": [0, 0, 0]}]}}})");
  nlohmann::json balls = json;
  balls["field"]["density"]["densities"][1]["center"][0] = 1001.0 + static_cast<double>(kGap);
  const Hypertexture h = hypertexture_from_json(balls, {"balls", ""});
  GeometryOptions options;
  options.keep = h.keep;
  const HypertextureGeometry geometry(
      h.field, std::make_shared<const topology::TopologyCache>(build_cache(h)), options);
  // From within the first ball outward: the hit nearest to the second one.
  const Imath::V3d o(1000.2, 0.0, 0.0), d(1.0, 0.0, 0.0);
  double t = 10.0;
  std::uint32_t brick = 0;
  for (std::uint32_t b = 0; b < geometry.statistics().bricks; ++b)
    if (const auto hit = geometry.intersect_brick(b, o, d, 0.0, t)) t = hit->t, brick = b;
  ASSERT_NEAR(t, 0.3, 1e-4);
  const ShadingPoint s = geometry.shade(brick, Imath::V3f(o + t * d));
  EXPECT_LT(s.spawn_front.x, 1000.5f + kGap + 1e-3f);
  EXPECT_GT(s.spawn_behind.x, 1000.4f);
  EXPECT_TRUE(s.spawn_verified);
  EXPECT_LT(s.spawn_front.x, 1000.5f + kGap);
  EXPECT_LT(h.field->value(Imath::V3d(s.spawn_front)), 0.0);
}

}  // namespace
}  // namespace morsel::geom

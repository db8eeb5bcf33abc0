// SPDX-License-Identifier: Apache-2.0
// 10^7 rays (or as many as the environment's MORSEL_RAYS says) at places where bricks meet on the
// surface, edges and lines on faces, with the object at the origin and far from it, rays from
// within, nearby and far away: none leaks.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <cstdlib>

#include "tests/hypertexture_geom/watertight.h"

namespace morsel::geom {
namespace {

constexpr double kDiameter = 1.6;

int rays() {
  const char* text = std::getenv("MORSEL_RAYS");
  return text ? std::max(1200, std::atoi(text)) : 10000000;
}

// A twelfth of the rays for each offset and distance.
void run(double offset, std::initializer_list<double> distances) {
  const Imath::V3d centre(offset * kDiameter + 0.1, -offset * kDiameter * 0.9 - 0.05,
                          offset * kDiameter * 0.8 + 0.02);
  const auto ball = std::make_shared<test::BallField>(centre, 0.5 * kDiameter);
  topology::CertifyOptions certify;
  certify.box = topology::dyadic_box({centre - Imath::V3d(1.0), centre + Imath::V3d(1.0)});
  certify.min_depth = 7;
  for (const double distance : distances) {
    GeometryOptions options;
    options.far_distance = std::max(100.0, distance / kDiameter);
    const HypertextureGeometry geometry(ball, test::certified_cache(*ball, certify), options);
    test::EmbreeScene scene;
    scene.attach(geometry.create(scene.device()));
    scene.commit();
    constexpr int kChunks = 64;
    tbb::parallel_for(0, kChunks, [&](int chunk) {
      test::expect_watertight(geometry, *ball, scene, distance, rays() / 12 / kChunks + 1,
                              static_cast<unsigned>(100 + chunk));
    });
    EXPECT_EQ(geometry.statistics().limits, 0u);
  }
}

TEST(WatertightSlow, AtTheOrigin) { run(0.0, {0.0, 3.0, 1600.0}); }
TEST(WatertightSlow, OneDiameterOff) { run(1.0, {0.0, 3.0, 1600.0}); }
TEST(WatertightSlow, AThousandDiametersOff) { run(1000.0, {0.0, 3.0, 1600.0}); }
// Float coordinates are a hundredth of the object apart here.
TEST(WatertightSlow, AHundredThousandDiametersOff) { run(1e5, {0.0, 3.0, 1600.0}); }

}  // namespace
}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "tests/hypertexture_geom/ball_field.h"
#include "tests/hypertexture_geom/embree_scene.h"

namespace morsel::geom::test {

// A ball of 3,100 bricks, shared by the tests of a suite, in a scene of each test's own.
class BallGeometryTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    ball_ = std::make_shared<BallField>(Imath::V3d(0.1, -0.05, 0.02), 0.8);
    topology::CertifyOptions options;
    options.box = topology::dyadic_box({Imath::V3d(-1.0), Imath::V3d(1.0)});
    options.min_depth = 5;
    geometry_ = std::make_shared<HypertextureGeometry>(ball_, certified_cache(*ball_, options),
                                                       GeometryOptions{});
  }
  static void TearDownTestSuite() {
    geometry_.reset();
    ball_.reset();
  }

  BallGeometryTest() {
    id_ = scene_.attach(geometry_->create(scene_.device()));
    scene_.commit();
  }

  static inline std::shared_ptr<BallField> ball_;
  static inline std::shared_ptr<HypertextureGeometry> geometry_;
  EmbreeScene scene_;
  unsigned id_ = 0;
};

// Directions all over the sphere.
inline Imath::V3f random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  Imath::V3f d;
  do {
    d = Imath::V3f(normal(random), normal(random), normal(random));
  } while (d.length2() < 1e-6f);
  return d.normalized();
}

inline Imath::V3f random_point(std::mt19937& random, float half) {
  std::uniform_real_distribution<float> u(-half, half);
  const float x = u(random), y = u(random);
  return {x, y, u(random)};
}

}  // namespace morsel::geom::test

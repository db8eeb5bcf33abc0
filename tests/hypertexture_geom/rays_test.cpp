// SPDX-License-Identifier: Apache-2.0
// Hits against a dense march; rays_slow_test.cpp does the same with ten times the rays.
#include <gtest/gtest.h>

#include "tests/hypertexture_geom/eq13.h"
#include "tests/hypertexture_geom/rays_against_march.h"

namespace morsel::geom {
namespace {

TEST(RaysAgainstMarch, OneLayer) { test::compare_with_march(test::eq13(1), 1.0 / 3, 20000); }

// An eighth of the object, whose octree takes an eighth of the time.
TEST(RaysAgainstMarch, TwoLayersInAnOctant) {
  Hypertexture rock = test::eq13(2);
  rock.certify.box = topology::dyadic_box({Imath::V3d(0.0), rock.certify.box.max});
  test::compare_with_march(rock, 1.0 / 6, 20000);
}

}  // namespace
}  // namespace morsel::geom

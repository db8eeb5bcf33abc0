// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/hypertexture_geom/eq13.h"
#include "tests/hypertexture_geom/rays_against_march.h"

namespace morsel::geom {
namespace {

TEST(RaysAgainstMarchSlow, OneLayer) { test::compare_with_march(test::eq13(1), 1.0 / 3, 200000); }
TEST(RaysAgainstMarchSlow, TwoLayers) { test::compare_with_march(test::eq13(2), 1.0 / 6, 200000); }
TEST(RaysAgainstMarchSlow, OneLayerDebrisOnly) {
  Hypertexture rock = test::eq13(1);
  rock.keep = topology::KeepRule::parse("detached");
  test::compare_with_march(rock, 1.0 / 3, 200000);
}

}  // namespace
}  // namespace morsel::geom

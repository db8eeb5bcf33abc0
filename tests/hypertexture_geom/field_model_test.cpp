// SPDX-License-Identifier: Apache-2.0
// Local models against the field itself: a bound that a sample point leaves is a wrong proof.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "hypertexture_geom/field/truncated_cube.h"
#include "tests/hypertexture_geom/soundness.h"
#include "tests/hypertexture_geom/test_fields.h"

namespace morsel::geom {
namespace {

using testing::count_outside;
using testing::eq13_json;
using testing::field_of;
using testing::FlushToZero;
using testing::hessian_of;
using testing::Outside;
using topology::Box;

TEST(FieldModel, BoundsHoldOnRandomBoxes) {
  for (const bool flush : {false, true}) {
    const FlushToZero mode(flush);
    std::mt19937_64 random(7);
    for (const int layers : {1, 2, 3, 5}) {
      const auto field = field_of(eq13_json(layers, layers));
      const Outside outside = count_outside(*field, random, 600, 24);
      EXPECT_EQ(outside.total(), 0)
          << "layers " << layers << ": value " << outside.value << ", gradient " << outside.gradient
          << ", Hessian " << outside.hessian << ", range " << outside.range << ", face "
          << outside.face;
    }
  }
}

TEST(FieldModel, AWeakenedBoundIsNoticed) {
  std::mt19937_64 random(7);
  const auto field = field_of(eq13_json(2, 1));
  const Outside outside = count_outside(*field, random, 400, 24, 0.3);
  EXPECT_GT(outside.value, 0);
  EXPECT_GT(outside.gradient, 0);
}

TEST(FieldModel, SphereApexAndSharpSmoothing) {
  std::mt19937_64 random(3);
  for (const double smoothing : {1e-6, 1e-3, 0.3}) {
    const auto field =
        field_of({{"density", {{"type", "sphere"}, {"radius", 0.7}, {"smoothing", smoothing}}}});
    EXPECT_EQ(count_outside(*field, random, 2000, 16).total(), 0) << smoothing;
    // Boxes about the apex itself.
    for (int n = 0; n < 60; ++n) {
      const Imath::V3d half(std::ldexp(1.0, -n / 2));
      const topology::Interval range = field->model(Box(-half, half)).range();
      EXPECT_LE(range.lo, field->value(half));
      EXPECT_GE(range.hi, field->value(Imath::V3d(0.0)));
    }
  }
}

TEST(FieldModel, RestrictionsGiveTheSameField) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto field = field_of(eq13_json(3, 9));
  for (int n = 0; n < 300; ++n) {
    const Imath::V3d c(2.0 * unit(random), 2.0 * unit(random), 2.0 * unit(random));
    const double width = std::ldexp(1.0, -static_cast<int>(random() % 10));
    const Box outer(c - Imath::V3d(width), c + Imath::V3d(width)), inner(c, c + Imath::V3d(width));
    const auto once = field->restricted_to(inner);
    const auto twice = field->restricted_to(outer)->restricted_to(inner);
    for (int k = 0; k < 10; ++k) {
      const Imath::V3d x =
          c + Imath::V3d(std::abs(unit(random)), std::abs(unit(random)), std::abs(unit(random))) *
                  width;
      const double whole = field->value(x);
      EXPECT_NEAR(once->value(x), whole, 1e-13);
      EXPECT_NEAR(twice->value(x), whole, 1e-13);
      EXPECT_NEAR(twice->jet(x).value, whole, 1e-13);
    }
  }
}

TEST(FieldModel, JetsAgreeWithDifferences) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto field = field_of(eq13_json(2, 4));
  constexpr double kStep = 1e-5;
  for (int n = 0; n < 200; ++n) {
    const Imath::V3d x(2.0 * unit(random), 2.0 * unit(random), 2.0 * unit(random));
    const topology::Jet jet = field->jet(x);
    for (int i = 0; i < 3; ++i) {
      Imath::V3d e(0.0);
      e[i] = kStep;
      EXPECT_NEAR(jet.gradient[i], (field->value(x + e) - field->value(x - e)) / (2.0 * kStep),
                  2e-7);
      for (int j = 0; j < 3; ++j)
        EXPECT_NEAR(hessian_of(jet, i, j),
                    (field->jet(x + e).gradient[j] - field->jet(x - e).gradient[j]) / (2.0 * kStep),
                    1e-2);
    }
  }
}

TEST(TruncatedCube, ErrorsHoldForEveryShapeOfInterval) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int n = 0; n < 20000; ++n) {
    double lo = -3.0 * std::pow(unit(random), 4), hi = std::pow(unit(random), 4);
    if (n % 7 == 0) lo = -lo * 0.3;
    if (n % 11 == 0) hi = -hi;
    if (lo > hi) std::swap(lo, hi);
    const double q0 = lo + (hi - lo) * unit(random);
    const CubicPiece p = truncated_cube(q0, lo, hi);
    for (int k = 0; k <= 20; ++k) {
      const double q = lo + (hi - lo) * k / 20.0, e = q - q0, t = std::max(0.0, q);
      const double slack = 1e-12;
      EXPECT_LE(std::abs(p.a[0] + e * (p.a[1] + e * (p.a[2] + e * p.a[3])) - t * t * t),
                p.error[0] + slack);
      EXPECT_LE(std::abs(p.a[1] + e * (2.0 * p.a[2] + e * 3.0 * p.a[3]) - 3.0 * t * t),
                p.error[1] + slack);
      EXPECT_LE(std::abs(2.0 * p.a[2] + 6.0 * p.a[3] * e - 6.0 * t), p.error[2] + slack);
    }
  }
}

}  // namespace
}  // namespace morsel::geom

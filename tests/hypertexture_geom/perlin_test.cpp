// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/perlin.h"

#include <gtest/gtest.h>

#include "hypertexture_geom/field/perlin_lattice.h"
#include "tests/hypertexture_geom/soundness.h"
#include "tests/hypertexture_geom/test_fields.h"

namespace morsel::geom {
namespace {

using testing::count_outside;
using testing::FlushToZero;
using testing::hessian_of;
using testing::Outside;
using topology::Box;

std::unique_ptr<Expression> perlin(int layers, double frequency, std::uint32_t seed,
                                   double amplitude = 0.8) {
  return make_perlin(
      {.octaves = fbm_octaves(amplitude, frequency, layers, 2.0, 0.8), .seed = seed});
}

// The definition, in long double and as plainly as can be.
long double reference(const Imath::V3d& x, double frequency, std::uint32_t seed) {
  const PerlinLattice lattice(0, seed);
  long double t[3], s[3];
  std::int64_t cell[3];
  for (int a = 0; a < 3; ++a) {
    const long double p = static_cast<long double>(x[a]) * frequency + lattice.offset()[a];
    cell[a] = static_cast<std::int64_t>(std::floor(p));
    t[a] = p - static_cast<long double>(cell[a]);
    s[a] = 6 * std::pow(t[a], 5) - 15 * std::pow(t[a], 4) + 10 * std::pow(t[a], 3);
  }
  long double sum = 0;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k) {
        const double* g =
            kPerlinDirection[lattice.direction(cell[0] + i, cell[1] + j, cell[2] + k)];
        sum += (i ? s[0] : 1 - s[0]) * (j ? s[1] : 1 - s[1]) * (k ? s[2] : 1 - s[2]) *
               (g[0] * (t[0] - i) + g[1] * (t[1] - j) + g[2] * (t[2] - k));
      }
  return sum;
}

TEST(Perlin, IsItsDefinition) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-50.0, 50.0);
  for (const double frequency : {1.0, 3.7}) {
    const auto noise = make_perlin({.octaves = {{1.0, frequency}}, .seed = 9});
    for (int n = 0; n < 20000; ++n) {
      const Imath::V3d x(place(random), place(random), place(random));
      // The rounding of a coordinate of size 185 times the steepest slope.
      EXPECT_NEAR(noise->value(x), static_cast<double>(reference(x, frequency, 9)), 3e-13);
    }
  }
}

TEST(Perlin, IsZeroAtLatticePoints) {
  for (const double frequency : {0.25, 1.0, 4.0, 64.0}) {
    const Imath::V3d offset = PerlinLattice(0, 3).offset();
    const auto noise = make_perlin({.octaves = {{1.0, frequency}}, .seed = 3});
    for (int i = -3; i <= 3; ++i)
      for (int j = -3; j <= 3; ++j) {
        const Imath::V3d point = (Imath::V3d(i, j, 2 * i - j) - offset) / frequency;
        EXPECT_EQ(noise->value(point), 0.0);
        // The value on a plane of the lattice is not.
        EXPECT_NE(noise->value(point + Imath::V3d(0.0, 0.3, 0.4) / frequency), 0.0);
      }
  }
}

TEST(Perlin, OctavesDoNotMeetInTheirZeros) {
  const auto noise = perlin(4, 1.0, 1);
  const Imath::V3d origin = -PerlinLattice(0, 1).offset();
  int zeros = 0;
  for (int i = 0; i < 8; ++i) zeros += std::abs(noise->value(origin + Imath::V3d(i, 0, 0))) < 1e-9;
  EXPECT_EQ(zeros, 0);
}

TEST(Perlin, HasTheStandardDeviationThatIsDocumented) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place(-1000.0, 1000.0);
  const auto noise = make_perlin({.octaves = {{1.0, 1.0}}, .seed = 5});
  constexpr int kSamples = 200000;
  double sum = 0.0, squares = 0.0, most = 0.0;
  for (int n = 0; n < kSamples; ++n) {
    const double v = noise->value(Imath::V3d(place(random), place(random), place(random)));
    sum += v;
    squares += v * v;
    most = std::max(most, std::abs(v));
  }
  // 5 standard errors; that of a variance is about its square root's times sqrt(2 / n) at most.
  EXPECT_LT(std::abs(sum / kSamples), 5.0 * 0.27 / std::sqrt(kSamples));
  EXPECT_NEAR(std::sqrt(squares / kSamples), 0.2700, 5.0 * 0.27 / std::sqrt(2.0 * kSamples));
  EXPECT_LE(most, noise->expected_range().hi);
}

TEST(PerlinLattice, DirectionsAreUniformAndIndependent) {
  int count[kPerlinDirections] = {}, pairs[3][kPerlinDirections][kPerlinDirections] = {};
  const PerlinLattice lattice(2, 77), other(3, 77);
  constexpr int kSide = 60;
  for (int i = -kSide / 2; i < kSide / 2; ++i)
    for (int j = 0; j < kSide; ++j)
      for (int k = 0; k < kSide; ++k) {
        const int d = lattice.direction(i, j, k);
        ++count[d];
        ++pairs[0][d][lattice.direction(i + 1, j, k)];
        ++pairs[1][d][lattice.direction(i, j + 1, k + 1)];
        ++pairs[2][d][other.direction(i, j, k)];
      }
  const double n = std::pow(kSide, 3);
  const auto chi_squared = [n](const int* begin, int cells) {
    double sum = 0.0;
    for (int c = 0; c < cells; ++c) sum += std::pow(begin[c] - n / cells, 2) / (n / cells);
    return sum;
  };
  // Expected 11 and 143; limits at a probability of 1e-5.
  EXPECT_LT(chi_squared(count, 12), 46.0);
  for (const auto& p : pairs) EXPECT_LT(chi_squared(&p[0][0], 144), 228.0);
}

TEST(PerlinLattice, NoPeriodOf256) {
  const PerlinLattice lattice(0, 1);
  int equal = 0;
  for (int i = 0; i < 256; ++i)
    equal += lattice.direction(i, 0, 0) == lattice.direction(i + 256, 0, 0);
  EXPECT_LT(equal, 60);  // 21 expected
}

TEST(Perlin, JetsAgreeWithDifferences) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto field = perlin(2, 2.0, 4);
  constexpr double kStep = 1e-5;
  for (int n = 0; n < 300; ++n) {
    Imath::V3d x(2.0 * unit(random), 2.0 * unit(random), 2.0 * unit(random));
    // A third of the places on planes of the first octave.
    if (n % 3 == 0)
      x[n % 2] = (std::round(2.0 * x[n % 2]) - PerlinLattice(0, 4).offset()[n % 2]) / 2.0;
    const topology::Jet jet = field->jet(x);
    EXPECT_NEAR(jet.value, field->value(x), 1e-14);
    for (int i = 0; i < 3; ++i) {
      Imath::V3d e(0.0);
      e[i] = kStep;
      EXPECT_NEAR(jet.gradient[i], (field->value(x + e) - field->value(x - e)) / (2.0 * kStep),
                  1e-6);
      for (int j = 0; j < 3; ++j)
        EXPECT_NEAR(hessian_of(jet, i, j),
                    (field->jet(x + e).gradient[j] - field->jet(x - e).gradient[j]) / (2.0 * kStep),
                    2e-2);
    }
  }
}

TEST(Perlin, IsTwiceContinuouslyDifferentiableAcrossPlanes) {
  // Differences that lie on one side of a plane each, through value and gradient and Hessian.
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(-3.0, 3.0);
  const auto noise = make_perlin({.octaves = {{1.0, 1.0}}, .seed = 8});
  constexpr double kStep = 1e-4;
  for (int n = 0; n < 300; ++n) {
    const int axis = n % 3;
    Imath::V3d x(unit(random), unit(random), unit(random)), e(0.0);
    x[axis] = std::round(x[axis]) - PerlinLattice(0, 8).offset()[axis];
    e[axis] = kStep;
    const topology::Jet at = noise->jet(x);
    for (const double side : {-1.0, 1.0}) {
      const topology::Jet near = noise->jet(x + e * side);
      for (int i = 0; i < 6; ++i) EXPECT_NEAR(near.hessian[i], at.hessian[i], 152.0 * kStep);
      // One-sided: v(h), v(2h) from v(0) by Taylor's formula with the plane's own derivatives.
      for (const double h : {kStep, 2.0 * kStep}) {
        const double t = side * h;
        EXPECT_NEAR(noise->value(x + e * (t / kStep)),
                    at.value + t * (at.gradient[axis] + 0.5 * t * at.hessian[axis]),
                    152.0 / 6.0 * h * h * h + 1e-14);
      }
    }
  }
}

TEST(Perlin, RestrictionsGiveTheSameField) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto field = perlin(3, 4.0, 9);
  const Imath::V3d offset = PerlinLattice(0, 9).offset();
  for (int n = 0; n < 600; ++n) {
    Imath::V3d c(2.0 * unit(random), 2.0 * unit(random), 2.0 * unit(random));
    double width = std::ldexp(1.0, -static_cast<int>(random() % 10));
    if (n % 2 == 0) {  // faces on lattice planes
      for (int a = 0; a < 3; ++a) c[a] = (std::round(4.0 * c[a]) - offset[a]) / 4.0;
      width = 0.25 * (1 + n % 3);
    }
    const Box outer(c - Imath::V3d(width), c + Imath::V3d(width)), inner(c, c + Imath::V3d(width));
    const auto once = field->restricted_to(inner);
    const auto twice = field->restricted_to(outer)->restricted_to(inner);
    for (int k = 0; k < 12; ++k) {
      Imath::V3d x = inner.min + Imath::V3d(std::abs(unit(random)), std::abs(unit(random)),
                                            std::abs(unit(random))) *
                                     width;
      if (k < 8)
        x = Imath::V3d(k & 1 ? inner.max.x : c.x, k & 2 ? inner.max.y : c.y,
                       k & 4 ? inner.max.z : c.z);
      const topology::Jet whole = field->jet(x), part = twice->jet(x);
      EXPECT_NEAR(once->value(x), whole.value, 1e-14);
      EXPECT_NEAR(twice->value(x), whole.value, 1e-14);
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(part.gradient[i], whole.gradient[i], 1e-12);
      for (int i = 0; i < 6; ++i) EXPECT_NEAR(part.hessian[i], whole.hessian[i], 1e-10);
    }
  }
}

TEST(PerlinModel, BoundsHoldOnRandomBoxes) {
  for (const bool flush : {false, true}) {
    const FlushToZero mode(flush);
    std::mt19937_64 random(7);
    for (const double frequency : {0.1, 1.0, 4.0, 7.3})
      for (const int layers : {1, 4}) {
        const auto field = perlin(layers, frequency, 3);
        const Outside outside = count_outside(*field, random, 800, 24);
        EXPECT_EQ(outside.total(), 0) << frequency << " " << layers << ": " << outside.text();
      }
  }
}

// Boxes whose centres, faces, edges or corners lie on planes of the lattice, exactly or by a hair.
TEST(PerlinModel, BoundsHoldWherePlanesMeetTheBox) {
  for (const bool flush : {false, true}) {
    const FlushToZero mode(flush);
    std::mt19937_64 random(8);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (const double frequency : {0.25, 1.0, 4.0}) {
      const auto noise = make_perlin({.octaves = {{1.0, frequency}}, .seed = 3});
      const Imath::V3d offset = PerlinLattice(0, 3).offset();
      Outside outside;
      for (int n = 0; n < 3000; ++n) {
        Box box;
        const double width = std::ldexp(1.0, -1 - static_cast<int>(random() % 22));
        for (int a = 0; a < 3; ++a) {
          const double plane = static_cast<double>(random() % 9) - 4.0 - offset[a];
          double lo = plane, hi = plane;
          switch (random() % 6) {
            case 0:  // centred on the plane
              lo -= 0.5 * width;
              hi += 0.5 * width;
              break;
            case 1:  // above it
              hi += width;
              break;
            case 2:  // below it
              lo -= width;
              break;
            case 3:  // in it
              break;
            case 4: {  // across it somewhere
              const double part = 0.5 + 0.5 * unit(random);
              lo -= part * width;
              hi += (1.0 - part) * width;
              break;
            }
            default:  // a rounding beyond it
              lo = std::nextafter(plane, -100.0);
              hi += width;
          }
          box.min[a] = lo / frequency;
          box.max[a] = hi / frequency;
        }
        testing::add_outside(*noise, box, random, 16, 1.0, outside);
      }
      EXPECT_EQ(outside.total(), 0) << frequency << ": " << outside.text();
    }
  }
}

TEST(PerlinModel, AWeakenedBoundIsNoticed) {
  std::mt19937_64 random(7);
  const auto field = perlin(2, 3.0, 1);
  const Outside outside = count_outside(*field, random, 400, 24, 0.3);
  EXPECT_GT(outside.value, 0);
  EXPECT_GT(outside.gradient, 0);
  EXPECT_GT(outside.hessian, 0);
}

TEST(PerlinModel, HugeFarAndEmptyBoxes) {
  const auto field = perlin(3, 4.0, 1);
  const double bound = field->expected_range().hi;
  for (const double size : {1.0, 1e3, 1e9, 1e18}) {
    const topology::LocalModel m = field->model(Box(Imath::V3d(-size), Imath::V3d(size)));
    EXPECT_LE(m.range().hi, 1.001 * bound);
    EXPECT_GE(m.range().hi, 0.99 * bound);
    EXPECT_TRUE(m.gradient_range(0).contains(30.0) && m.gradient_range(0).contains(-10.0));
    const Imath::V3d far(size, -size, size);
    const topology::Interval there = field->model(Box(far, far)).range();
    EXPECT_TRUE(there.contains(field->value(far))) << size;
    EXPECT_LE(std::abs(field->value(far)), bound);
    EXPECT_EQ(field->restricted_to(Box(far, far))->value(far), field->value(far));
  }
  // Powers of the size overflow: nothing is known then, but that soundly.
  const topology::LocalModel vast = field->model(Box(Imath::V3d(-1e300), Imath::V3d(1e300)));
  EXPECT_TRUE(vast.range().contains(-bound) && vast.range().contains(bound));
  EXPECT_GE(vast.value_error, 0.999 * bound);
  // A point: the model is the jet.
  const Imath::V3d x(0.31, -0.42, 0.53);
  const topology::LocalModel m = field->model(Box(x, x));
  const topology::Jet jet = field->jet(x);
  EXPECT_LT(m.value_error, 1e-11);
  EXPECT_NEAR(m.c[0], jet.value, 1e-11);
  EXPECT_NEAR(m.c[topology::monomial::kX], jet.gradient.x, 1e-8);
  EXPECT_LT(m.gradient_error.x, 1e-8);
}

TEST(PerlinJson, ImpulsesAreRefusedAndLeftOut) {
  nlohmann::json json = testing::perlin_json(2, 1);
  const nlohmann::json canonical = testing::field_of(json)->canonical_json();
  EXPECT_FALSE(canonical["modulations"][0].contains("impulses_per_cell"));
  EXPECT_EQ(testing::field_of(canonical)->canonical_json(), canonical);
  EXPECT_TRUE(testing::field_of(testing::eq13_json(2, 1))
                  ->canonical_json()["modulations"][0]
                  .contains("impulses_per_cell"));
  json["modulations"][0]["impulses_per_cell"] = 3;
  try {
    testing::field_of(json);
    FAIL() << "accepted";
  } catch (const params::InputError& e) {
    const std::string message = e.what();
    EXPECT_NE(message.find("/modulations/0/impulses_per_cell"), std::string::npos) << message;
    EXPECT_NE(message.find("sparse_convolution"), std::string::npos) << message;
  }
}

TEST(Perlin, RefusesBadOctaves) {
  EXPECT_THROW(make_perlin({.octaves = {{1.0, 0.0}}}), std::invalid_argument);
  EXPECT_THROW(make_perlin({.octaves = {{std::nan(""), 1.0}}}), std::invalid_argument);
}

}  // namespace
}  // namespace morsel::geom

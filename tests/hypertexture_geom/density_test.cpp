// SPDX-License-Identifier: Apache-2.0
// The densities: proofs of their models, smoothness, slopes, bounding boxes and volumes.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "hypertexture_geom/field/registry.h"
#include "tests/hypertexture_geom/random_density.h"
#include "tests/hypertexture_geom/soundness.h"
#include "topology/certified.h"

namespace morsel::geom {
namespace {

using nlohmann::json;
using testing::count_outside;
using testing::random_density;
using topology::Box;
using topology::Jet;

std::unique_ptr<Expression> density(const json& description) {
  return density_from_json(description, params::Place{"test", ""});
}

double unit(std::mt19937_64& random) {
  return std::uniform_real_distribution<double>(-1.0, 1.0)(random);
}

Imath::V3d point(std::mt19937_64& random, double reach) {
  const double x = unit(random), y = unit(random), z = unit(random);
  return Imath::V3d(x, y, z) * reach;
}

class EveryDensity : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryDensity, BoundsHoldOnRandomBoxes) {
  for (const bool flush : {false, true}) {
    const testing::FlushToZero mode(flush);
    std::mt19937_64 random(41);
    for (int n = 0; n < 24; ++n) {
      const json description = random_density(GetParam(), random);
      const auto field = density(description);
      const auto outside = count_outside(*field, random, 100, 16, 1.0, 2.0);
      EXPECT_EQ(outside.total(), 0) << outside.text() << " of " << description;
      // Much farther than the object is large, and in one huge box.
      const auto far = count_outside(*field, random, 20, 10, 1.0, 1e3);
      EXPECT_EQ(far.total(), 0) << far.text() << " of " << description;
      const Imath::V3d huge(1e150);
      const topology::LocalModel m = field->model(Box(-huge, huge));
      EXPECT_GE(m.range().hi, field->value(Imath::V3d(0.1)));
      EXPECT_LE(m.range().lo, field->value(Imath::V3d(1e100)));
      for (int i = 0; i < 3; ++i) EXPECT_GE(m.gradient_error[i], 0.0);
      EXPECT_GE(m.value_error, 0.0);
      EXPECT_GE(m.hessian_error, 0.0);
    }
  }
}

TEST_P(EveryDensity, JetsAgreeWithDifferences) {
  std::mt19937_64 random(5);
  constexpr double kStep = 1e-5;
  for (int n = 0; n < 12; ++n) {
    json description = random_density(GetParam(), random);
    if (description.contains("smoothing")) description["smoothing"] = 0.08;
    const auto field = density(description);
    for (int k = 0; k < 40; ++k) {
      const Imath::V3d x = point(random, 2.0);
      const Jet jet = field->jet(x);
      EXPECT_NEAR(field->value(x), jet.value, 1e-13 * (1.0 + std::abs(jet.value)));
      // Second derivatives of booleans grow with 1 / width.
      double size = 1.0;
      for (const double h : jet.hessian) size = std::max(size, std::abs(h));
      for (int i = 0; i < 3; ++i) {
        Imath::V3d e(0.0);
        e[i] = kStep;
        const Jet above = field->jet(x + e), below = field->jet(x - e);
        EXPECT_NEAR(jet.gradient[i], (above.value - below.value) / (2.0 * kStep),
                    1e-8 * size * size * size)
            << description;
        for (int j = 0; j < 3; ++j)
          EXPECT_NEAR(testing::hessian_of(jet, i, j),
                      (above.gradient[j] - below.gradient[j]) / (2.0 * kStep),
                      1e-8 * size * size * size + 1e-4 * size)
              << description;
      }
    }
  }
}

TEST_P(EveryDensity, RestrictionsGiveTheSameField) {
  std::mt19937_64 random(11);
  for (int n = 0; n < 40; ++n) {
    const auto field = density(random_density(GetParam(), random));
    const Imath::V3d c = point(random, 1.5), w(std::ldexp(1.0, -static_cast<int>(random() % 8)));
    const Box outer(c - w, c + w), inner(c, c + w);
    const auto local = field->restricted_to(outer)->restricted_to(inner);
    for (int k = 0; k < 10; ++k) {
      const Imath::V3d u = point(random, 1.0);
      const Imath::V3d x = c + Imath::V3d(std::abs(u.x), std::abs(u.y), std::abs(u.z)) * w;
      EXPECT_NEAR(local->value(x), field->value(x), 1e-13);
      EXPECT_NEAR(local->jet(x).value, field->value(x), 1e-13);
    }
  }
}

TEST_P(EveryDensity, SlopesAreAtMostTheDocumentedOnes) {
  std::mt19937_64 random(23);
  double steepest = 0.0;
  for (int n = 0; n < 60; ++n) {
    const json description = random_density(GetParam(), random, 1);
    double bound = 1.0;
    const auto with = [&](const json& d) {
      if (d["type"] != "metaballs") return;
      double sum = 0.0;
      for (const json& ball : d["balls"])
        sum += 1.7174 * std::abs(ball["weight"].get<double>()) / ball["radius"].get<double>();
      bound = std::max(bound, sum);
    };
    with(description);
    if (description.contains("densities"))
      for (const json& d : description["densities"]) with(d);
    const auto field = density(description);
    for (int k = 0; k < 300; ++k) {
      const double slope = field->jet(point(random, k % 2 ? 2.0 : 0.8)).gradient.length();
      EXPECT_LE(slope, bound * (1.0 + 1e-12)) << description;
      steepest = std::max(steepest, slope / bound);
    }
  }
  EXPECT_GT(steepest, 0.5);  // or the bound says little
}

TEST_P(EveryDensity, BoxesAndRangesHoldTheSolid) {
  std::mt19937_64 random(31);
  int inside = 0;
  for (int n = 0; n < 60; ++n) {
    const json description = random_density(GetParam(), random);
    const auto field = density(description);
    const topology::Interval range = field->expected_range();
    for (const double level : {0.0, 0.1, -0.2}) {
      const auto box = field->superlevel_box(level);
      for (int k = 0; k < 200; ++k) {
        const Imath::V3d x = point(random, 2.5);
        const double value = field->value(x);
        EXPECT_LE(value, range.hi);
        EXPECT_GE(value, range.lo);
        if (value < level || !box) continue;
        EXPECT_TRUE(!box->isEmpty() && box->intersects(x)) << x << " " << description;
        ++inside;
      }
    }
  }
  if (GetParam() != "slab") {
    EXPECT_GT(inside, 100);
  }
}

INSTANTIATE_TEST_SUITE_P(Densities, EveryDensity,
                         ::testing::Values("sphere", "ellipsoid", "rounded_box", "torus", "capsule",
                                           "slab", "metaballs", "union", "intersection",
                                           "difference"),
                         [](const auto& test) { return test.param; });

// Boxes about the places where a formula is nearly singular, at every smoothing.
TEST(Density, BoundsHoldAtApexesEdgesAndEndPlanes) {
  struct Case {
    json description;
    std::vector<Imath::V3d> places;
  };
  std::mt19937_64 random(3);
  for (const double s : {1e-6, 1e-3, 0.05}) {
    const std::vector<Case> cases{
        {{{"type", "ellipsoid"}, {"radii", {0.5, 1.0, 0.2}}, {"smoothing", s}}, {{0, 0, 0}}},
        {{{"type", "rounded_box"},
          {"half_size", {1.0, 0.5, 0.8}},
          {"rounding", 0.2},
          {"smoothing", s}},
         {{0, 0, 0}, {0.8, 0, 0}, {0.8, 0.3, 0}, {0.8, 0.3, 0.6}, {1, 0.3, 0.1}, {0.8, 0.5, 0}}},
        {{{"type", "torus"}, {"axis", {0, 0, 1}}, {"smoothing", s}},
         {{0, 0, 0}, {1, 0, 0}, {std::sqrt(0.5), std::sqrt(0.5), 0}, {1.3, 0, 0}, {0, 0, 1}}},
        {{{"type", "capsule"}, {"radius", 0.3}, {"smoothing", s}},
         {{0, 0, 0}, {1, 0, 0}, {1, 0.3, 0}, {1.3, 0, 0}, {0.5, 0, 0}}},
        {{{"type", "slab"}, {"axis", {0, 0, 2}}, {"smoothing", s}}, {{0, 0, 0}, {5, 3, 0}}},
        {{{"type", "union"},
          {"width", s},
          {"densities", {{{"type", "sphere"}}, {{"type", "sphere"}, {"center", {1.0, 0, 0}}}}}},
         {{0.5, 0, 0}, {0.5, 0.5, 0.5}, {0.5, std::sqrt(0.75), 0}}},
        {{{"type", "difference"},
          {"width", s},
          {"densities", {{{"type", "sphere"}}, {{"type", "sphere"}, {"center", {1.0, 0, 0}}}}}},
         {{0.5, 0, 0}, {0.5, std::sqrt(0.75), 0}}}};
    for (const Case& c : cases) {
      const auto field = density(c.description);
      for (const Imath::V3d& place : c.places)
        for (const double reach : {0.0, 1e-6, 1e-3, 0.1}) {
          const auto outside = count_outside(*field, random, 60, 12, 1.0, reach, place);
          EXPECT_EQ(outside.total(), 0) << outside.text() << " of " << c.description << " at "
                                        << place << " within " << reach;
        }
    }
  }
}

// The tests above would notice.
TEST(Density, AWeakenedBoundIsNoticed) {
  std::mt19937_64 random(13);
  for (const char* type : {"torus", "rounded_box", "difference"}) {
    testing::Outside all;
    for (int n = 0; n < 10; ++n) {
      const auto field = density(random_density(type, random));
      const auto outside = count_outside(*field, random, 100, 16, 0.2, 1.0);
      all.value += outside.value;
      all.gradient += outside.gradient;
    }
    EXPECT_GT(all.value, 0) << type;
    EXPECT_GT(all.gradient, 0) << type;
  }
}

// Second derivatives are continuous where a naive formula's would jump: across the planes where
// faces pass into edges, the capsule's end planes, the torus's axis and the core.
TEST(Density, SecondDerivativesAreContinuous) {
  const std::vector<std::pair<json, Imath::V3d>> cases{
      {{{"type", "rounded_box"}, {"rounding", 0.3}, {"smoothing", 0.05}}, {0.7, 0.9, 0.2}},
      {{{"type", "rounded_box"}, {"rounding", 0.3}, {"smoothing", 0.05}}, {0.7, 0.7, 0.7}},
      {{{"type", "capsule"}, {"smoothing", 0.05}}, {1.0, 0.3, 0.1}},
      {{{"type", "capsule"}, {"smoothing", 0.05}}, {0.3, 0.0, 0.0}},
      {{{"type", "torus"}, {"smoothing", 0.05}}, {0.0, 0.2, 0.0}},
      {{{"type", "torus"}, {"smoothing", 0.05}}, {1.0, 0.0, 0.0}},
      {{{"type", "slab"}, {"smoothing", 0.05}}, {0.3, 0.0, 0.2}},
      {{{"type", "metaballs"}, {"balls", {{{"radius", 1.0}}}}}, {0.6, 0.8, 0.0}}};
  std::mt19937_64 random(9);
  for (const auto& [description, place] : cases) {
    const auto field = density(description);
    for (int k = 0; k < 30; ++k) {
      const Imath::V3d d = point(random, 1e-7);
      const Jet a = field->jet(place + d), b = field->jet(place - d);
      for (int i = 0; i < 6; ++i)
        EXPECT_NEAR(a.hessian[i], b.hessian[i], 2e-3) << description << " " << i;
    }
  }
}

// --- Volumes ----------------------------------------------------------------------------------

struct Solid {
  std::uint64_t components;
  double volume_lo, volume_hi;
};

Solid certified(const json& description, int min_depth) {
  const auto field = density(description);
  topology::CertifyOptions options;
  const Box outer = *field->superlevel_box(0.0);
  const Imath::V3d margin = (outer.max - outer.min) * 0.05;
  options.box = topology::dyadic_box(Box(outer.min - margin, outer.max + margin));
  options.min_depth = min_depth;
  const topology::Topology t = topology::certify(*field, options);
  EXPECT_TRUE(t.certified) << description;
  EXPECT_FALSE(t.touches_box.has_value()) << description;
  Solid solid{t.components.size(), 0.0, 0.0};
  for (const topology::Component& c : t.components) {
    solid.volume_lo += c.volume_lo;
    solid.volume_hi += c.volume_hi;
  }
  return solid;
}

void expect_one_of_volume(const json& description, double volume) {
  const Solid solid = certified(description, 5);
  EXPECT_EQ(solid.components, 1u) << description;
  EXPECT_LE(solid.volume_lo, volume) << description;
  EXPECT_GE(solid.volume_hi, volume) << description;
  EXPECT_LT(solid.volume_hi - solid.volume_lo, 0.6 * volume) << description;
}

TEST(Density, CertifiedVolumesEncloseTheClosedForms) {
  using std::numbers::pi;
  constexpr double s = 0.02;  // smoothing
  expect_one_of_volume({{"type", "sphere"}, {"smoothing", s}},
                       4.0 / 3.0 * pi * std::pow(1.0 - s * s, 1.5));
  expect_one_of_volume({{"type", "ellipsoid"}, {"radii", {1.0, 0.5, 0.7}}, {"smoothing", s}},
                       4.0 / 3.0 * pi * 0.35 * std::pow(1.0 - s * s / 0.25, 1.5));
  // With rho as the variable the smoothed torus has the volume of one of squared tube radius
  // minor^2 - s^2.
  for (const Imath::V3d& axis : {Imath::V3d(0, 0, 1), Imath::V3d(1, 2, -1)})
    expect_one_of_volume({{"type", "torus"},
                          {"axis", {axis.x, axis.y, axis.z}},
                          {"major_radius", 0.8},
                          {"minor_radius", 0.4},
                          {"smoothing", s}},
                         2.0 * pi * pi * 0.8 * (0.16 - s * s));
  // Discs along the segment, by the trapezoidal rule.
  const Imath::V3d a(-0.5, -0.2, 0.0), b(0.6, 0.4, 0.3);
  const double half = 0.5 * (b - a).length(), radius = 0.3, crown = 0.2,
               t = crown * radius / (half + radius);
  double volume = 0.0;
  for (double u = -half - 0.4, du = 1e-4; u < half + 0.4; u += du) {
    const double e = 0.5 * (std::hypot(u - half, s) + std::hypot(u + half, s)) - half;
    volume += pi * du * std::max(0.0, radius * radius - e * e - t * t * u * u - s * s);
  }
  expect_one_of_volume({{"type", "capsule"},
                        {"start", {a.x, a.y, a.z}},
                        {"end", {b.x, b.y, b.z}},
                        {"radius", radius},
                        {"smoothing", s},
                        {"crown", crown}},
                       volume);
  expect_one_of_volume({{"type", "metaballs"}, {"balls", {{{"radius", 1.5}}}}, {"level", 0.2}},
                       4.0 / 3.0 * pi * std::pow(1.5 * std::sqrt(1.0 - std::cbrt(0.2)), 3));
}

TEST(Density, RoundedBoxesLieWithinTheirHalfSizes) {
  const json box{{"type", "rounded_box"}, {"half_size", {1.0, 0.5, 0.7}}, {"rounding", 0.2}};
  const auto field = density(box);
  for (int i = 0; i < 3; ++i) {
    Imath::V3d face(0.0);
    const double half = box["half_size"][i];
    face[i] = half;
    EXPECT_LT(field->value(face), 0.0);
    face[i] = half - 0.004;
    EXPECT_GT(field->value(face), 0.0);
  }
  // A corner is the inner box's plus the rounding.
  const double reach = 0.2 / std::sqrt(3.0);
  EXPECT_LT(field->value({0.8 + reach, 0.3 + reach, 0.5 + reach}), 0.0);
  EXPECT_GT(field->value({0.8 + 0.9 * reach, 0.3 + 0.9 * reach, 0.5 + 0.9 * reach}), 0.0);
  EXPECT_EQ(certified(box, 4).components, 1u);
}

TEST(Density, TwoMetaballsJoinedAndApart) {
  const auto two = [](double distance) {
    return json{
        {"type", "metaballs"},
        {"balls", {{{"center", {-0.5 * distance, 0, 0}}}, {{"center", {0.5 * distance, 0, 0}}}}},
        {"level", 0.3}};
  };
  // On the plane between them both are (1 - d^2 / 4)^3, and reach 0.15 at d = 1.368.
  EXPECT_EQ(certified(two(1.2), 3).components, 1u);
  EXPECT_EQ(certified(two(1.36), 3).components, 1u);
  EXPECT_EQ(certified(two(1.38), 3).components, 2u);
  EXPECT_EQ(certified(two(1.7), 3).components, 2u);
}

TEST(Density, BooleansCountAsSetOperationsDo) {
  const json left{{"type", "sphere"}, {"center", {-0.4, 0, 0}}, {"radius", 0.5}},
      right{{"type", "sphere"}, {"center", {0.4, 0, 0}}, {"radius", 0.5}},
      bar{{"type", "capsule"}, {"start", {-1, 0, 0}}, {"end", {1, 0, 0}}, {"radius", 0.2}},
      wall{{"type", "slab"}, {"axis", {1, 0, 0}}, {"half_thickness", 0.2}};
  const auto of = [](const char* type, const json& list) {
    return json{{"type", type}, {"densities", list}, {"width", 0.05}};
  };
  EXPECT_EQ(certified(of("union", {left, right}), 3).components, 1u);
  EXPECT_EQ(certified(of("intersection", {left, right}), 3).components, 1u);
  // A wall through a bar leaves two ends; an unbounded part is bounded by the other.
  EXPECT_EQ(certified(of("difference", {bar, wall}), 3).components, 2u);
  EXPECT_EQ(certified(of("intersection", {bar, wall}), 3).components, 1u);
  EXPECT_EQ(certified(of("difference", {of("union", {left, right}), bar, wall}), 3).components, 2u);
}

// What each width inflates: at most width / 2 where two parts meet.
TEST(Density, BooleansMoveTheSurfaceByHalfTheirWidth) {
  std::mt19937_64 random(8);
  const json a{{"type", "sphere"}}, b{{"type", "sphere"}, {"center", {0.7, 0, 0}}};
  const auto in_a = density(a), in_b = density(b);
  for (const double width : {1e-3, 0.1, 0.5}) {
    const json list{a, b};
    const auto joined = density({{"type", "union"}, {"densities", list}, {"width", width}});
    const auto common = density({{"type", "intersection"}, {"densities", list}, {"width", width}});
    const auto rest = density({{"type", "difference"}, {"densities", list}, {"width", width}});
    for (int k = 0; k < 500; ++k) {
      const Imath::V3d x = point(random, 2.0);
      const double p = in_a->value(x), q = in_b->value(x), half = 0.5 * width, slack = 1e-12;
      EXPECT_GE(joined->value(x), std::max(p, q) - slack);
      EXPECT_LE(joined->value(x), std::max(p, q) + half + slack);
      EXPECT_LE(common->value(x), std::min(p, q) + slack);
      EXPECT_GE(common->value(x), std::min(p, q) - half - slack);
      EXPECT_LE(rest->value(x), std::min(p, -q) + slack);
      EXPECT_GE(rest->value(x), std::min(p, -q) - half - slack);
    }
    const Imath::V3d between(0.35, 0.4, 0.1);
    EXPECT_NEAR(joined->value(between), in_a->value(between) + 0.5 * width, 1e-12);
  }
}

}  // namespace
}  // namespace morsel::geom

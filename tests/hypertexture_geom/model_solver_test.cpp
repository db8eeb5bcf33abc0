// SPDX-License-Identifier: Apache-2.0
// The first root by a cubic and its errors, against dense sampling, on functions that stray from
// the cubic as far as the errors allow.
#include "hypertexture_geom/embree/model_solver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

namespace morsel::geom {
namespace {

// g(s) = P(s) + A sin(w s + phase) along x = (s, 0, 0).
struct Wavy {
  double c[4], amplitude, frequency, phase;
  double value(double s) const {
    return c[0] + s * (c[1] + s * (c[2] + s * c[3])) + amplitude * std::sin(frequency * s + phase);
  }
  double slope(double s) const {
    return c[1] + s * (2.0 * c[2] + 3.0 * s * c[3]) +
           amplitude * frequency * std::cos(frequency * s + phase);
  }
  RayCubic cubic() const {
    return {{static_cast<float>(c[0]), static_cast<float>(c[0] + c[1] / 3.0),
             static_cast<float>(c[0] + 2.0 / 3.0 * c[1] + c[2] / 3.0),
             static_cast<float>(c[0] + c[1] + c[2] + c[3])}};
  }
  RayCubicError error() const {
    double size = 0.0;
    for (const double k : c) size += std::abs(k);
    const double rounding = 1e-6 * size;
    return {static_cast<float>(amplitude * 1.00001 + rounding),
            static_cast<float>(amplitude * frequency * 1.00001 + 6.0 * rounding),
            static_cast<float>(amplitude * frequency * frequency * 1.00001 + 24.0 * rounding)};
  }
};

constexpr double kTolerance = 1e-9;

ModelResult solve(const Wavy& g, bool strict, bool any) {
  const auto value = [&](double s) { return g.value(s); };
  const auto with_gradient = [&](double s, Imath::V3d& gradient, double& slope) {
    slope = g.slope(s);
    gradient = Imath::V3d(slope, 0.0, 0.0);
    return g.value(s);
  };
  const RayCubicError error = g.error();
  return ModelSolver(value, with_gradient, error, kTolerance).solve(g.cubic(), strict, any);
}

// First sign change by small steps and bisection.
std::optional<double> march(const Wavy& g, int steps) {
  double a = 0.0, ga = g.value(0.0);
  for (int i = 1; i <= steps; ++i) {
    double b = i / static_cast<double>(steps);
    const double gb = g.value(b);
    if ((ga < 0.0) != (gb < 0.0)) {
      for (int k = 0; k < 60; ++k) {
        const double m = 0.5 * (a + b);
        ((g.value(m) < 0.0) == (ga < 0.0) ? a : b) = m;
      }
      return a;
    }
    a = b;
    ga = gb;
  }
  return std::nullopt;
}

Wavy random_wavy(std::mt19937& random, int kind) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Wavy g{};
  for (double& c : g.c) c = normal(random) * std::exp2(-4.0 * unit(random));
  // Grazing: the cubic has a double root, or nearly one.
  if (kind % 3 == 1) {
    const double r = unit(random), scale = normal(random), k = normal(random);
    const double lift = normal(random) * std::exp2(-30.0 * unit(random));
    // scale (s - r)^2 (1 + k s) + lift
    g.c[0] = scale * r * r + lift;
    g.c[1] = scale * (-2.0 * r + k * r * r);
    g.c[2] = scale * (1.0 - 2.0 * k * r);
    g.c[3] = scale * k;
  }
  // Starts at zero, or nearly.
  if (kind % 3 == 2) g.c[0] = normal(random) * std::exp2(-40.0 * unit(random));
  g.amplitude = std::exp2(-4.0 - 20.0 * unit(random));
  g.frequency = 1.0 + 20.0 * unit(random);
  g.phase = 6.3 * unit(random);
  return g;
}

TEST(ModelSolver, FindsTheFirstRoot) {
  std::mt19937 random(1);
  int hits = 0, limits = 0;
  for (int i = 0; i < 60000; ++i) {
    const Wavy g = random_wavy(random, i);
    const std::optional<double> expected = march(g, 500);
    const ModelResult r = solve(g, false, false), any = solve(g, false, true);
    limits += r.limit;
    ASSERT_EQ(r.hit, any.hit) << i;
    if (!r.hit) {
      ASSERT_FALSE(expected) << i;
      continue;
    }
    ++hits;
    // A root: F changes its sign there, or touches zero.
    const double reach = 4.0 * kTolerance;
    const double before = g.value(r.s - reach), after = g.value(r.s + reach);
    EXPECT_TRUE((before < 0.0) != (after < 0.0) || std::abs(g.value(r.s)) < 1e-12)
        << i << " at " << r.s << ": " << before << " " << after;
    // The first one: the march finds none before it, but may step over it.
    if (expected) {
      ASSERT_LE(r.s, *expected + reach) << i;
    }
    EXPECT_GE(r.beyond, r.s);
    EXPECT_LE(r.beyond, r.s + 0.1);
    if (r.has_gradient) {
      EXPECT_EQ(r.gradient.x, g.slope(r.gradient_at)) << i;
      EXPECT_NEAR(r.gradient_at, r.s, 0.1) << i;
    }
  }
  EXPECT_GT(hits, 10000);
  EXPECT_EQ(limits, 0);
}

TEST(ModelSolver, NeverSkipsAnEarlierRoot) {
  // Finer marches, fewer functions.
  std::mt19937 random(2);
  for (int i = 0; i < 2000; ++i) {
    const Wavy g = random_wavy(random, i);
    const std::optional<double> expected = march(g, 20000);
    const ModelResult r = solve(g, false, false);
    if (expected) {
      ASSERT_TRUE(r.hit) << i;
      ASSERT_LE(r.s, *expected + 4.0 * kTolerance) << i;
    }
  }
}

TEST(ModelSolver, ExactCubicsNeedOneEvaluationAtMost) {
  const Wavy far{{1.0, 0.2, 0.1, 0.0}, 0.0, 1.0, 0.0};
  const ModelResult none = solve(far, false, false);
  EXPECT_FALSE(none.hit);
  EXPECT_EQ(none.evaluations, 0);
  const Wavy through{{-1.0, 2.5, 0.1, 0.3}, 0.0, 1.0, 0.0};
  const ModelResult hit = solve(through, false, false);
  EXPECT_TRUE(hit.hit);
  EXPECT_LE(hit.evaluations, 2);
  EXPECT_NEAR(through.value(hit.s), 0.0, 1e-8);
  const ModelResult any = solve(through, false, true);
  EXPECT_TRUE(any.hit);
  EXPECT_EQ(any.evaluations, 0);
}

// The parabola of the model's curvature leaves an error of the third order.
TEST(ModelSolver, CurvatureOfTheModelSavesEvaluations) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int evaluations = 0;
  constexpr int kCount = 1000;
  for (int i = 0; i < kCount; ++i) {
    const double bend = unit(random) - 0.5;
    const Wavy g{{-0.2 - 0.4 * unit(random), 1.0 - bend, bend, 0.0}, 1e-4, 0.5, 6.3 * unit(random)};
    const ModelResult r = solve(g, false, false);
    ASSERT_TRUE(r.hit) << i;
    EXPECT_NEAR(g.value(r.s), 0.0, 2.0 * kTolerance) << i;
    evaluations += r.evaluations;
  }
  EXPECT_LE(evaluations, kCount + kCount / 50);
}

// The search for a next root must not start at this one, where F may round to either sign.
TEST(ModelSolver, GoesOnBeyondARootThatItMetExactly) {
  for (const double way : {1.0, -1.0}) {
    const Wavy g{{-0.5 * way, way, 0.0, 0.0}, 0.0, 1.0, 0.0};
    const ModelResult r = solve(g, false, false);
    ASSERT_TRUE(r.hit);
    EXPECT_EQ(r.s, 0.5);
    EXPECT_GE(r.beyond, 0.5 + 0.5 * kTolerance);
  }
}

// One end within the band: F there tells whether there is a root, and one evaluation is enough.
TEST(ModelSolver, MonotonePartsAreDecidedByTheirEnds) {
  for (const double phase : {1.5, 4.7}) {  // the wave lifts the end, or lowers it
    const Wavy g{{-1.0, 1.0, 0.0, 0.0}, 1e-3, 0.1, phase};
    const ModelResult r = solve(g, false, false), any = solve(g, false, true);
    EXPECT_EQ(r.hit, phase < 3.0);
    EXPECT_EQ(any.hit, r.hit);
    EXPECT_EQ(any.evaluations, 1);
    EXPECT_LE(r.evaluations, r.hit ? 3 : 1);
    const Wavy back{{0.0, 1.0, 0.0, 0.0}, 1e-3, 0.1, phase};  // the same of the start
    const ModelResult s = solve(back, true, false);
    EXPECT_EQ(s.hit, phase > 3.0);
    EXPECT_LE(s.evaluations, s.hit ? 3 : 1);
  }
}

TEST(ModelSolver, StrictLeavesOutARootAtTheStart) {
  const Wavy rising{{0.0, 1.0, 0.0, 0.0}, 0.0, 1.0, 0.0};
  EXPECT_TRUE(solve(rising, false, false).hit);
  EXPECT_FALSE(solve(rising, true, false).hit);
  const Wavy again{{0.0, 1.0, -2.0, 0.0}, 0.0, 1.0, 0.0};  // roots at 0 and 1/2
  const ModelResult r = solve(again, true, false);
  ASSERT_TRUE(r.hit);
  EXPECT_NEAR(r.s, 0.5, 1e-8);
}

TEST(ModelSolver, KnowsNothingAndStillFindsRoots) {
  const Wavy g{{-0.3, 1.0, 0.0, 0.0}, 0.0, 1.0, 0.0};
  const auto value = [&](double s) { return g.value(s); };
  const auto with_gradient = [&](double s, Imath::V3d& gradient, double& slope) {
    slope = g.slope(s);
    gradient = Imath::V3d(slope, 0.0, 0.0);
    return g.value(s);
  };
  const RayCubicError nothing{1e30f, 1e30f, 1e30f};
  const ModelResult r = ModelSolver(value, with_gradient, nothing, kTolerance)
                            .solve({{0.0f, 0.0f, 0.0f, 0.0f}}, false, false);
  EXPECT_TRUE(r.hit);
  EXPECT_NEAR(r.s, 0.3, 1.0 / 32);
  EXPECT_TRUE(r.limit);  // and says that it can't be certain
}

// The cubic along a ray is the cubic in space.
TEST(RayCubic, RestrictsToARay) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  for (int i = 0; i < 10000; ++i) {
    topology::LocalModel m;
    float c[topology::monomial::kCount], sum = 0.0f;
    for (int k = 0; k < topology::monomial::kCount; ++k) {
      c[k] = unit(random);
      m.c[static_cast<std::size_t>(k)] = static_cast<double>(c[k]);
      sum += std::abs(c[k]);
    }
    float a[3], step[3];
    for (int k = 0; k < 3; ++k) {
      a[k] = unit(random);
      step[k] = unit(random) - a[k];
    }
    const RayCubic p = restrict_to_ray(c, a, step);
    for (int k = 0; k <= 10; ++k) {
      const auto s = static_cast<float>(k) / 10.0f;
      Imath::V3d u;
      for (int j = 0; j < 3; ++j)
        u[j] = static_cast<double>(a[j]) + static_cast<double>(s) * static_cast<double>(step[j]);
      const double exact = m.value_at(u);
      EXPECT_NEAR(static_cast<double>(p.value(s)), exact,
                  static_cast<double>(kRayCubicRounding * sum));
      Imath::V3d end;
      for (int j = 0; j < 3; ++j)
        end[j] = static_cast<double>(a[j]) + 0.75 * static_cast<double>(step[j]);
      const Imath::V3d change = m.gradient_at(end) - m.gradient_at(u);
      EXPECT_LT((cubic_gradient_change(c, a, step, s, 0.75f) - change).length(),
                static_cast<double>(6.0f * kRayCubicRounding * sum));
      EXPECT_NEAR(static_cast<double>(p.slope(s)),
                  m.gradient_at(u).dot({step[0], step[1], step[2]}),
                  static_cast<double>(6.0f * kRayCubicRounding * sum));
    }
  }
}

}  // namespace
}  // namespace morsel::geom

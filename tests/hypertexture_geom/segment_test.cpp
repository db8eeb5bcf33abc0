// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/segment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

namespace morsel::geom {
namespace {

constexpr double kTolerance = 1e-9;
constexpr double kHuge = 1e30;
constexpr RayBounds kUnknown{-kHuge, kHuge, -kHuge, kHuge};

// c + sum of a_k sin(w_k t + p_k), with the obvious bounds on its derivatives.
struct Waves {
  struct Wave {
    double a, w, p;
  };
  double c = 0.0;
  std::vector<Wave> waves;

  double operator()(double t) const {
    double s = c;
    for (const Wave& k : waves) s += k.a * std::sin(k.w * t + k.p);
    return s;
  }
  RayBounds bounds() const {
    RayBounds b;
    for (const Wave& k : waves) {
      b.slope_hi += std::abs(k.a * k.w);
      b.curvature_hi += std::abs(k.a * k.w * k.w);
    }
    b.slope_lo = -b.slope_hi;
    b.curvature_lo = -b.curvature_hi;
    return b;
  }
};

// First sign change among equally spaced samples, bisected.
std::optional<double> marched(const Waves& g, double length, int steps) {
  double previous = g(0.0);
  for (int i = 1; i <= steps; ++i) {
    double lo = length * (i - 1) / steps, hi = length * i / steps;
    const double value = g(hi);
    if ((value < 0.0) != (previous < 0.0)) {
      for (int k = 0; k < 60; ++k) {
        const double m = 0.5 * (lo + hi);
        ((g(m) < 0.0) == (previous < 0.0) ? lo : hi) = m;
      }
      return 0.5 * (lo + hi);
    }
    previous = value;
  }
  return std::nullopt;
}

TEST(Segment, AgreesWithADenseMarchOnRandomWaves) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int hits = 0;
  long evaluations = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Waves g;
    g.c = 1.6 * (unit(random) - 0.5);
    for (int k = 0; k < 4; ++k)
      g.waves.push_back({unit(random) / (k + 1), 1.0 + 3.0 * k * unit(random),
                         2 * std::numbers::pi * unit(random)});
    const double length = 0.05 + 4.0 * unit(random);
    const SegmentResult r = first_root(g, length, g.bounds(), kTolerance, false);
    const std::optional<double> expected = marched(g, length, 4000);
    ASSERT_FALSE(r.limit) << trial;
    evaluations += r.evaluations;
    if (!expected) {
      // The march may have stepped over two roots: the solver's must be one.
      if (r.hit) {
        EXPECT_LT(g(r.t - 1e-7) * g(r.t + 1e-7), 0.0) << trial;
      }
      continue;
    }
    ++hits;
    ASSERT_TRUE(r.hit) << trial;
    EXPECT_LE(r.t, *expected + 2 * kTolerance) << trial;
    if (r.t < *expected - 2 * kTolerance) {
      EXPECT_LT(g(r.t - 1e-7) * g(r.t + 1e-7), 0.0) << trial;
    } else {
      EXPECT_GE(r.beyond, *expected) << trial;
    }
  }
  EXPECT_GT(hits, 1000);
  RecordProperty("evaluations_per_segment_x100", static_cast<int>(evaluations / 30));
  EXPECT_LT(evaluations, 3000 * 14);
}

TEST(Segment, FindsBothCrossingDirections) {
  const RayBounds bounds{-1.0, 1.0, 0.0, 0.0};
  const auto up = [](double t) { return t - 0.3; };
  const auto down = [](double t) { return 0.3 - t; };
  EXPECT_NEAR(first_root(up, 1.0, bounds, kTolerance, false).t, 0.3, kTolerance);
  EXPECT_NEAR(first_root(down, 1.0, bounds, kTolerance, false).t, 0.3, kTolerance);
}

TEST(Segment, FindsTheFirstOfManyRoots) {
  // Roots at 0.08, 0.18, ..., 0.88: signs differ at the ends, yet the root is not unique.
  const double w = 10.0 * std::numbers::pi;
  const auto g = [&](double t) { return std::sin(w * (t + 0.02)); };
  const SegmentResult r = first_root(g, 0.95, {-w, w, -w * w, w * w}, kTolerance, false);
  ASSERT_TRUE(r.hit);
  EXPECT_NEAR(r.t, 0.08, kTolerance);
}

TEST(Segment, WalksThroughAllRootsByBeyond) {
  const auto g = [](double t) { return std::sin(t); };
  std::vector<double> roots;
  double start = 0.0;
  for (int i = 0; i < 20; ++i) {
    const auto shifted = [&](double t) { return g(start + t); };
    const SegmentResult r = first_root(shifted, 20.0 - start, {-1, 1, -1, 1}, kTolerance, true);
    if (!r.hit) break;
    roots.push_back(start + r.t);
    start += r.beyond;
  }
  ASSERT_EQ(roots.size(), 6u);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(roots[i], (i + 1) * std::numbers::pi, 2 * kTolerance);
}

TEST(Segment, SkipsWithOneEvaluationWhatSlopesExclude) {
  const auto g = [](double t) { return -1.0 + 0.1 * t; };
  const SegmentResult r = first_root(g, 5.0, {0.0, 0.15, 0.0, 0.0}, kTolerance, false);
  EXPECT_FALSE(r.hit);
  EXPECT_EQ(r.evaluations, 1);
}

TEST(Segment, LinearFunctionTakesThreeEvaluations) {
  const auto g = [](double t) { return t - 0.7; };
  const SegmentResult r = first_root(g, 1.0, {0.5, 1.5, -1.0, 1.0}, kTolerance, false);
  EXPECT_TRUE(r.hit);
  EXPECT_LE(r.evaluations, 3);
}

TEST(Segment, GrazingParabola) {
  // max g = -e: no hit, however small e is, and two close roots when e < 0.
  for (const double e : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const auto below = [&](double t) { return -e - (t - 0.37) * (t - 0.37); };
    const auto above = [&](double t) { return e - (t - 0.37) * (t - 0.37); };
    const RayBounds bounds{-3, 3, -2.5, -1.5};
    const SegmentResult miss = first_root(below, 1.0, bounds, 1e-9, false);
    EXPECT_FALSE(miss.hit) << e;
    EXPECT_FALSE(miss.limit) << e;
    const SegmentResult hit = first_root(above, 1.0, bounds, 1e-9, false);
    ASSERT_TRUE(hit.hit) << e;
    EXPECT_NEAR(hit.t, 0.37 - std::sqrt(e), 1e-9) << e;
    EXPECT_LT(hit.evaluations, 60) << e;
  }
}

TEST(Segment, RootsAtTheEnds) {
  const auto g = [](double t) { return t * (1.0 - t); };
  const RayBounds bounds{-1, 1, -2, -2};
  const SegmentResult at_start = first_root(g, 1.0, bounds, kTolerance, false);
  ASSERT_TRUE(at_start.hit);
  EXPECT_EQ(at_start.t, 0.0);
  // Leaving the surface at t = 0 is not a hit; the far end is.
  const SegmentResult at_end = first_root(g, 1.0, bounds, kTolerance, true);
  ASSERT_TRUE(at_end.hit);
  EXPECT_NEAR(at_end.t, 1.0, kTolerance);
  EXPECT_FALSE(first_root(g, 0.9, bounds, kTolerance, true).hit);
}

TEST(Segment, ShadowsStopAtTheFirstSignChange) {
  const auto g = [](double t) { return t - 0.7; };
  const SegmentResult r = first_root(g, 1.0, {0.5, 1.5, -1, 1}, kTolerance, false, true);
  EXPECT_TRUE(r.hit);
  EXPECT_EQ(r.evaluations, 2);
}

TEST(Segment, ReportsTheLimitInsteadOfGuessing) {
  const auto touching = [](double t) { return -1e-12 - (t - 0.37) * (t - 0.37); };
  const SegmentResult r = first_root(touching, 1.0, kUnknown, kTolerance, false);
  EXPECT_TRUE(r.limit);
  EXPECT_FALSE(r.hit);
  EXPECT_LE(r.evaluations, kMaxSegmentEvaluations);
}

TEST(Segment, EmptyAndTinyIntervals) {
  const auto g = [](double t) { return t - 1e-12; };
  EXPECT_TRUE(first_root(g, 1e-10, {1, 1, 0, 0}, kTolerance, false).hit);
  EXPECT_FALSE(first_root(g, 1e-13, {1, 1, 0, 0}, kTolerance, false).hit);
  EXPECT_FALSE(first_root(g, 0.0, {1, 1, 0, 0}, kTolerance, false).hit);
}

}  // namespace
}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
// Bounds of sums of impulses on boxes that are wide for them, against samples in long double.
#include "hypertexture_geom/field/impulse_range.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace morsel::geom {
namespace {

using Real = long double;

struct Sample {
  Real value = 0.0L, gradient[3] = {}, hessian = 0.0L;
};

Sample sample(const ImpulseList& impulses, const Imath::V3d& x) {
  Sample r;
  Real bend[3][3] = {};
  for (std::size_t n = 0; n < impulses.size(); ++n) {
    const Impulse p = impulses[n];
    const Real s = p.inverse_square, w = p.weight;
    Real d[3], q = 1.0L;
    for (int i = 0; i < 3; ++i) {
      d[i] = Real(x[i]) - p.centre[i];
      q -= s * d[i] * d[i];
    }
    if (q <= 0.0L) continue;
    r.value += w * q * q * q;
    for (int i = 0; i < 3; ++i) {
      r.gradient[i] -= 6.0L * w * s * d[i] * q * q;
      for (int j = 0; j < 3; ++j)
        bend[i][j] += w * (24.0L * s * s * q * d[i] * d[j] - (i == j ? 6.0L * s * q * q : 0.0L));
    }
  }
  for (const auto& row : bend)
    for (const Real b : row) r.hessian = std::max(r.hessian, std::abs(b));
  return r;
}

// `density` impulses in a cube of the kernel's radius, as far as they reach the box.
ImpulseList random_impulses(std::mt19937_64& random, const Imath::V3d& centre,
                            const Imath::V3d& half, double frequency, double density) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Imath::V3d reach = half + Imath::V3d(1.2 / frequency);
  const double count = density * std::pow(2.0 * frequency, 3) * reach.x * reach.y * reach.z;
  ImpulseList list;
  for (int n = 0; n < count; ++n) {
    const Imath::V3d offset(unit(random), unit(random), unit(random));
    list.push_back({centre + reach * offset, frequency * frequency, unit(random)});
  }
  return list;
}

TEST(ImpulseRange, HoldsEverywhereOnTheBox) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Real nearest_value = 0.0L, nearest_slope = 0.0L, nearest_bend = 0.0L;
  for (int n = 0; n < 120; ++n) {
    const double frequency = n % 7 == 0 ? 3e4 : 3.0;
    const double place = n % 5 == 0 ? 1e6 : 2.0;
    const Imath::V3d centre(place * unit(random), place * unit(random), place * unit(random));
    Imath::V3d half(0.5 * (0.9 + 7.0 * std::abs(unit(random))) / frequency);
    if (n % 3 == 1) half *= Imath::V3d(1.0, std::abs(unit(random)), std::abs(unit(random)));
    if (n % 4 == 1) half[static_cast<int>(random() % 3)] = 0.0;
    // A single impulse fills its bounds where it peaks.
    ImpulseList all = random_impulses(random, centre, half, frequency, n % 6 == 0 ? 0.0 : 3.0);
    if (all.empty())
      all.push_back({centre + half * unit(random), frequency * frequency, unit(random)});
    const ImpulseRange range = range_of(all, centre, half);
    for (int k = 0; k < 300; ++k) {
      Imath::V3d x = centre + half * Imath::V3d(unit(random), unit(random), unit(random));
      if (k < 8) x = centre + half * Imath::V3d(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
      if (k == 8) x = all[0].centre;
      bool inside = true;
      for (int i = 0; i < 3; ++i) inside = inside && std::abs(x[i] - centre[i]) <= half[i];
      if (!inside) continue;
      const Sample is = sample(all, x);
      ASSERT_GE(is.value, range.lo) << n;
      ASSERT_LE(is.value, range.hi) << n;
      const Real bound = is.value < 0.0L ? range.lo : range.hi;
      nearest_value = std::max(nearest_value, is.value / bound);
      for (int i = 0; i < 3; ++i) {
        ASSERT_LE(std::abs(is.gradient[i]), range.gradient[i]) << n;
        nearest_slope = std::max(nearest_slope, std::abs(is.gradient[i]) / range.gradient[i]);
      }
      ASSERT_LE(is.hessian, range.hessian) << n;
      nearest_bend = std::max(nearest_bend, is.hessian / range.hessian);
    }
  }
  // Smaller bounds would have been noticed.
  EXPECT_GT(nearest_value, 0.999L);
  EXPECT_GT(nearest_slope, 0.9L);
  EXPECT_GT(nearest_bend, 0.9L);
}

// What parts are for: on a box of four radii the sum of what every impulse can be is several times
// as large.
TEST(ImpulseRange, SaysMoreThanTheSumOfAllRanges) {
  std::mt19937_64 random(9);
  const Imath::V3d centre(0.1, 0.2, 0.3), half(2.0);
  const ImpulseList all = random_impulses(random, centre, half, 1.0, 3.0);
  const ImpulseRange range = range_of(all, centre, half);
  double sum = 0.0;
  for (std::size_t n = 0; n < all.size(); ++n) {
    double nearest = 0.0;
    for (int i = 0; i < 3; ++i)
      nearest += std::pow(std::max(0.0, std::abs(all[n].centre[i] - centre[i]) - half[i]), 2.0);
    if (nearest < 1.0) sum += std::max(0.0, all[n].weight) * std::pow(1.0 - nearest, 3.0);
  }
  EXPECT_GT(range.hi, 1.0);
  EXPECT_LT(range.hi, 0.2 * sum);
}

TEST(ImpulseRange, OfNothingIsZero) {
  const ImpulseRange none = range_of(ImpulseList(), Imath::V3d(0.0), Imath::V3d(1.0));
  EXPECT_EQ(none.lo, 0.0);
  EXPECT_EQ(none.hi, 0.0);
  ImpulseList far;
  far.push_back({Imath::V3d(9.0), 1.0, 1.0});
  const ImpulseRange away = range_of(far, Imath::V3d(0.0), Imath::V3d(2.0));
  EXPECT_EQ(away.hi, 0.0);
  EXPECT_EQ(away.gradient[0], 0.0);
  EXPECT_EQ(away.hessian, 0.0);
}

}  // namespace
}  // namespace morsel::geom

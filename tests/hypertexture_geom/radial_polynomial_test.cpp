// SPDX-License-Identifier: Apache-2.0
// Sums of whole impulses as one polynomial, moved from box to smaller box, against the impulses
// themselves in long double.
#include "hypertexture_geom/field/radial_polynomial.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "hypertexture_geom/field/impulse_model.h"
#include "tests/hypertexture_geom/test_fields.h"

namespace morsel::geom::testing {
namespace {

using topology::Box;
using Real = long double;

struct Jet2 {
  Real value = 0.0L, slope[3] = {}, bend[3][3] = {};
};

// Powers of x, y, z and the coefficient's place, written out from the definition.
struct Monomial {
  int power[3];
  Real coefficient;
};

std::vector<Monomial> monomials_of(const RadialPolynomial& p) {
  static constexpr int kCubic[topology::monomial::kCount][3] = {
      {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2},
      {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {2, 1, 0},
      {2, 0, 1}, {1, 2, 0}, {0, 2, 1}, {1, 0, 2}, {0, 1, 2}, {1, 1, 1}};
  static constexpr int kPair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  std::vector<Monomial> all;
  for (int n = 0; n < topology::monomial::kCount; ++n)
    all.push_back({{kCubic[n][0], kCubic[n][1], kCubic[n][2]}, p.c[n]});
  for (int n = 0; n < 6; ++n)
    for (int k = 0; k < 3; ++k) {
      Monomial m{{0, 0, 0}, (n < 3 ? 1.0L : 2.0L) * p.form[n]};
      m.power[k] += 2;
      ++m.power[kPair[n][0]];
      ++m.power[kPair[n][1]];
      all.push_back(m);
    }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        Monomial m{{0, 0, 0}, p.quintic[i]};
        ++m.power[i];
        m.power[j] += 2;
        m.power[k] += 2;
        all.push_back(m);
        if (i == 0)
          for (int l = 0; l < 3; ++l) {
            Monomial s{{0, 0, 0}, p.sextic};
            for (const int axis : {j, k, l}) s.power[axis] += 2;
            all.push_back(s);
          }
      }
  return all;
}

Real derivative(Real x, int power, int times) {
  Real factor = 1.0L;
  for (int n = 0; n < times; ++n) factor *= power - n;
  for (int n = times; n < power; ++n) factor *= x;
  return factor;
}

Jet2 jet_of(const RadialPolynomial& p, const Real (&x)[3]) {
  Jet2 jet;
  for (const Monomial& m : monomials_of(p)) {
    const auto term = [&](int i, int j) {
      Real t = m.coefficient;
      for (int axis = 0; axis < 3; ++axis)
        t *= derivative(x[axis] - p.centre[axis], m.power[axis], (axis == i) + (axis == j));
      return t;
    };
    jet.value += term(-1, -1);
    for (int i = 0; i < 3; ++i) {
      jet.slope[i] += term(i, -1);
      for (int j = 0; j < 3; ++j) jet.bend[i][j] += term(i, j);
    }
  }
  return jet;
}

Jet2 jet_of(const ImpulseList& impulses, const Real (&x)[3]) {
  Jet2 jet;
  for (std::size_t n = 0; n < impulses.size(); ++n) {
    const Impulse p = impulses[n];
    const Real s = p.inverse_square, w = p.weight;
    Real d[3], q = 1.0L;
    for (int i = 0; i < 3; ++i) {
      d[i] = x[i] - Real(p.centre[i]);
      q -= s * d[i] * d[i];
    }
    EXPECT_GT(q, 0.0L);
    jet.value += w * q * q * q;
    for (int i = 0; i < 3; ++i) {
      jet.slope[i] += w * 3.0L * q * q * (-2.0L * s * d[i]);
      for (int j = 0; j < 3; ++j)
        jet.bend[i][j] +=
            w * (24.0L * q * s * s * d[i] * d[j] - (i == j ? 6.0L * q * q * s : 0.0L));
    }
  }
  return jet;
}

// How much of its bounds the polynomial uses at a point of the box, at most 1 where they hold.
double used(const RadialPolynomial& p, const ImpulseList& impulses, const Real (&x)[3]) {
  const Jet2 is = jet_of(p, x), should = jet_of(impulses, x);
  Real most = std::abs(is.value - should.value) / p.error[0];
  for (int i = 0; i < 3; ++i) {
    most = std::max(most, std::abs(is.slope[i] - should.slope[i]) / p.error[1]);
    for (int j = 0; j < 3; ++j)
      most = std::max(most, std::abs(is.bend[i][j] - should.bend[i][j]) / p.error[2]);
  }
  return static_cast<double>(most);
}

TEST(RadialPolynomial, IsTheSumOfItsImpulsesAboutEveryCentre) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double most = 0.0, most_moved = 0.0;
  for (int n = 0; n < 24; ++n) {
    // Kernels of several sizes about places of their own, all of which hold the box.
    const Imath::V3d about(10.0 * unit(random), unit(random), unit(random));
    const double width = n % 4 == 0 ? 0.3 : 0.05;
    Box box(about - Imath::V3d(0.5 * width), about + Imath::V3d(0.5 * width));
    ImpulseList all, whole, cut;
    for (int k = 0; k < 40; ++k)
      all.push_back({about + 0.8 * Imath::V3d(unit(random), unit(random), unit(random)),
                     std::ldexp(0.25, static_cast<int>(random() % 5)), unit(random)});
    RadialSum sum(box);
    all.sort(sum.centre(), sum.half(), whole, cut);
    ASSERT_FALSE(whole.empty());
    add_terms(whole, sum);
    RadialPolynomial p = sum.polynomial();
    const RadialPolynomial first = p;
    double weights = 0.0;
    for (std::size_t k = 0; k < whole.size(); ++k) weights += std::abs(whole[k].weight);
    EXPECT_LE(first.error[0], 1e-11 * weights);
    for (int level = 0; level <= 24; ++level) {
      // Rounding, and no more than that.
      for (int k = 0; k < 3; ++k) EXPECT_LE(p.error[k], 4.0 * first.error[k]);
      for (int k = 0; k < 12; ++k) {
        Real x[3];
        for (int i = 0; i < 3; ++i)
          x[i] = k < 8 ? ((k >> i) & 1 ? box.max[i] : box.min[i])
                       : box.min[i] + 0.5L * (1.0L + unit(random)) * (box.max[i] - box.min[i]);
        const double here = used(p, whole, x);
        EXPECT_LE(here, 1.0) << "level " << level;
        (level == 0 ? most : most_moved) = std::max(level == 0 ? most : most_moved, here);
      }
      box = topology::child_box(box, static_cast<int>(random() % 8));
      RadialSum next(box);
      next.add(p);
      p = next.polynomial();
    }
  }
  // The bounds are not so wide that nothing could break them: a ten-thousandth of them would not
  // hold.
  EXPECT_GT(most, 1e-4);
  EXPECT_GT(most_moved, 1e-4);
}

// Lists are sorted by the same geometry as a plain loop finds, whatever the vector width.
TEST(ImpulseList, SortsByWhatTheKernelsHold) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int numbers[3] = {};
  for (int n = 0; n < 50; ++n) {
    const Imath::V3d centre(unit(random), unit(random), unit(random));
    const Imath::V3d half(0.2, 0.3 * std::abs(unit(random)), n % 5 == 0 ? 0.0 : 0.1);
    ImpulseList all, whole, cut;
    for (int k = 0; k < 533; ++k)
      all.push_back({Imath::V3d(2 * unit(random), 2 * unit(random), 2 * unit(random)),
                     0.5 + std::abs(unit(random)), 1.0 + k});
    all.sort(centre, half, whole, cut);
    std::size_t at_whole = 0, at_cut = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Impulse p = all[k];
      Real near = 0.0L, far = 0.0L;
      for (int i = 0; i < 3; ++i) {
        const Real away = std::abs(Real(p.centre[i]) - centre[i]);
        near += std::pow(std::max(0.0L, away - half[i]), 2.0L);
        far += std::pow(away + half[i], 2.0L);
      }
      const int kind = p.inverse_square * near >= 1.0L ? 0 : p.inverse_square * far > 1.0L ? 1 : 2;
      ++numbers[kind];
      if (kind == 2) {
        ASSERT_LT(at_whole, whole.size());
        EXPECT_EQ(whole[at_whole++].weight, p.weight);
      } else if (kind == 1) {
        ASSERT_LT(at_cut, cut.size());
        EXPECT_EQ(cut[at_cut++].weight, p.weight);
      }
    }
    EXPECT_EQ(at_whole, whole.size());
    EXPECT_EQ(at_cut, cut.size());
  }
  for (const int number : numbers) EXPECT_GT(number, 500);
}

}  // namespace
}  // namespace morsel::geom::testing

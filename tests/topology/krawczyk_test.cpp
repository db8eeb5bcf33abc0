// SPDX-License-Identifier: Apache-2.0
// What is proved of the zeros of a gradient in one box, against systems whose zeros are known.
#include "topology/morse/krawczyk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "topology/morse/zero.h"
#include "topology/octree.h"

namespace morsel::topology {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Box cube(double half, const Imath::V3d& centre = Imath::V3d(0.0)) {
  return {centre - Imath::V3d(half), centre + Imath::V3d(half)};
}

bool holds(const Box& outer, const Box& inner) {
  return outer.intersects(inner.min) && outer.intersects(inner.max);
}

// F = g.x + 1/2 x'Hx + sum t_i x_i^3 / 3, H as xx, yy, zz, xy, xz, yz: its model is itself.
// Remembers the hull of where it was asked for.
class Cubic : public ScalarField {
 public:
  Cubic(const Imath::V3d& g, const std::array<double, 6>& h, const Imath::V3d& t = Imath::V3d(0.0))
      : g_(g), h_(h), t_(t) {}

  double value(const Imath::V3d& x) const override { return jet(x).value; }

  Jet jet(const Imath::V3d& x) const override {
    asked_.extendBy(x);
    Jet jet;
    const Imath::V3d hx(h_[0] * x.x + h_[3] * x.y + h_[4] * x.z,
                        h_[3] * x.x + h_[1] * x.y + h_[5] * x.z,
                        h_[4] * x.x + h_[5] * x.y + h_[2] * x.z);
    jet.value = g_.dot(x) + 0.5 * hx.dot(x);
    jet.gradient = g_ + hx;
    for (int i = 0; i < 6; ++i) jet.hessian[i] = h_[i];
    for (int i = 0; i < 3; ++i) {
      jet.value += t_[i] * x[i] * x[i] * x[i] / 3.0;
      jet.gradient[i] += t_[i] * x[i] * x[i];
      jet.hessian[i] += 2.0 * t_[i] * x[i];
    }
    return jet;
  }

  LocalModel model(const Box& box) const override {
    asked_.extendBy(box);
    LocalModel m;
    m.centre = centre(box);
    m.half = half_size(box);
    const Jet at = jet(m.centre);
    m.c[monomial::k1] = at.value;
    const int mixed[3] = {monomial::kXY, monomial::kXZ, monomial::kYZ};
    const int cubes[3] = {monomial::kXXX, monomial::kYYY, monomial::kZZZ};
    for (int i = 0; i < 3; ++i) {
      m.c[monomial::kX + i] = at.gradient[i];
      m.c[monomial::kXX + i] = 0.5 * at.hessian[i];
      m.c[mixed[i]] = at.hessian[3 + i];
      m.c[cubes[i]] = t_[i] / 3.0;
      m.gradient_error[i] = error + 1e-14 * (1.0 + box.max.length2() + box.min.length2());
    }
    m.value_error = 1e-14 * (1.0 + box.max.length2() + box.min.length2());
    m.hessian_error = 1e-14;
    m.add_rounding();
    return m;
  }

  std::unique_ptr<ScalarField> restricted_to(const Box&) const override {
    return std::make_unique<Cubic>(*this);
  }

  double error = 0.0;  // of the models' gradients: bounds may be as loose as they like
  const Box& asked() const { return asked_; }
  void forget() { asked_.makeEmpty(); }

 private:
  Imath::V3d g_;
  std::array<double, 6> h_;
  Imath::V3d t_;
  mutable Box asked_;
};

// grad F = H (x - zero), H with eigenvalues of both signs.
Cubic saddle_at(const Imath::V3d& zero) {
  const std::array<double, 6> h{2.0, -1.5, 0.7, 0.3, -0.2, 0.4};
  const Imath::V3d g = -Cubic(Imath::V3d(0.0), h).jet(zero).gradient;
  return {g, h};
}

TEST(Krawczyk, OneZeroOfALinearSystem) {
  const Imath::V3d zero(0.3, -0.2, 0.15);
  const Cubic field = saddle_at(zero);
  for (const double half : {1e-6, 1e-3, 0.1, 10.0, 1e4}) {
    // The zero is anywhere inside, not at the centre.
    const Box box = cube(half, zero + Imath::V3d(0.6, -0.7, 0.5) * half);
    const Krawczyk k = krawczyk_on(field, box);
    EXPECT_EQ(k.zeros, ZeroCount::kOne) << half;
    EXPECT_TRUE(k.enclosure.intersects(zero)) << half;
    EXPECT_TRUE(holds(box, k.enclosure)) << half;
    // The operator is Newton's method here: exact but for rounding.
    EXPECT_LT((k.enclosure.max - k.enclosure.min).length(), 1e-9 * (1.0 + half * half)) << half;
    EXPECT_FALSE(excludes_zero(field.model(box)));
  }
}

TEST(Krawczyk, NoZeroWhereThereIsNone) {
  const Imath::V3d zero(0.3, -0.2, 0.15);
  const Cubic field = saddle_at(zero);
  for (const double half : {1e-6, 1e-3, 0.1, 10.0})
    for (const Imath::V3d& away : {Imath::V3d(1.01, 0, 0), Imath::V3d(0, -1.01, 0),
                                   Imath::V3d(0.5, 0.5, 1.01), Imath::V3d(-3, 40, 7)}) {
      const Box box = cube(half, zero + away * half);
      EXPECT_EQ(krawczyk_on(field, box).zeros, ZeroCount::kNone) << half << away;
      EXPECT_TRUE(excludes_zero(field.model(box))) << half << away;
    }
}

TEST(Krawczyk, AZeroOnTheWallIsNeitherProvedNorLost) {
  const Imath::V3d zero(0.25, -0.5, 0.125);
  const Cubic field = saddle_at(zero);
  for (const Imath::V3d& side :
       {Imath::V3d(1, 0, 0), Imath::V3d(0, -1, 0), Imath::V3d(1, 1, 0), Imath::V3d(-1, 1, -1)}) {
    const Krawczyk k = krawczyk_on(field, cube(0.5, zero + side * 0.5));
    EXPECT_EQ(k.zeros, ZeroCount::kUnknown) << side;
    EXPECT_TRUE(k.enclosure.intersects(zero)) << side;
  }
}

// A box without extent: at the zero nothing can be strictly inside; elsewhere there is none.
TEST(Krawczyk, BoxesWithoutExtent) {
  const Imath::V3d zero(0.25, -0.5, 0.125);
  const Cubic field = saddle_at(zero);
  EXPECT_EQ(krawczyk_on(field, Box(zero, zero)).zeros, ZeroCount::kUnknown);
  const Imath::V3d off = zero + Imath::V3d(1e-3, 0, 0);
  EXPECT_EQ(krawczyk_on(field, Box(off, off)).zeros, ZeroCount::kNone);
}

// grad F = x_i^2 - a^2 along each axis: eight zeros at (+-a, +-a, +-a).
TEST(Krawczyk, SeveralZerosAreNeverOneNorNone) {
  const double a = 0.5;
  const Cubic field(Imath::V3d(-a * a), {0, 0, 0, 0, 0, 0}, Imath::V3d(1.0));
  for (const Box& box :
       {cube(0.6), cube(1.0), cube(100.0), Box(Imath::V3d(-0.6, 0.4, 0.4), Imath::V3d(0.7))}) {
    const Krawczyk k = krawczyk_on(field, box);
    EXPECT_EQ(k.zeros, ZeroCount::kUnknown);
    EXPECT_FALSE(excludes_zero(field.model(box)));
    for (int i = 0; i < 8; ++i) {
      const Imath::V3d zero((i & 1) ? a : -a, (i & 2) ? a : -a, (i & 4) ? a : -a);
      EXPECT_EQ(box.intersects(zero), k.enclosure.intersects(zero)) << zero;
    }
  }
  // One zero in a loose box, whose Hessian changes sign: open; in a tight one: proved.
  const Imath::V3d zero(a, -a, a);
  EXPECT_EQ(krawczyk_on(field, cube(0.6, zero)).zeros, ZeroCount::kUnknown);
  EXPECT_EQ(krawczyk_on(field, cube(0.05, zero + Imath::V3d(0.01))).zeros, ZeroCount::kOne);
  EXPECT_EQ(krawczyk_on(field, cube(0.05, zero + Imath::V3d(0.1))).zeros, ZeroCount::kNone);
}

// All answers are true and splitting what is open finds every zero.
TEST(Krawczyk, SplittingFindsEveryZeroOfRandomSystems) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::size_t proved = 0;
  for (int trial = 0; trial < 200; ++trial) {
    // (x_i - p_i)(x_i - q_i) t_i along each axis.
    Imath::V3d p, q, t;
    for (int i = 0; i < 3; ++i) {
      p[i] = uniform(random);
      q[i] = p[i] + (uniform(random) > 0 ? 1.0 : -1.0) * (0.05 + std::abs(uniform(random)));
      t[i] = (uniform(random) > 0 ? 1.0 : -1.0) * (0.2 + std::abs(uniform(random)));
    }
    const Cubic field(t * p * q,
                      {-t.x * (p.x + q.x), -t.y * (p.y + q.y), -t.z * (p.z + q.z), 0, 0, 0}, t);
    std::vector<Imath::V3d> inside;
    const Box all(Imath::V3d(-0.9, -1.0, -1.1), Imath::V3d(1.1, 0.95, 1.0));
    for (int i = 0; i < 8; ++i) {
      const Imath::V3d zero((i & 1) ? p.x : q.x, (i & 2) ? p.y : q.y, (i & 4) ? p.z : q.z);
      if (all.intersects(zero)) inside.push_back(zero);
    }
    std::vector<Box> found, stack{all};
    int boxes = 0;
    while (!stack.empty() && ++boxes < 100000) {
      const Box box = stack.back();
      stack.pop_back();
      const Krawczyk k = krawczyk_on(field, box);
      int zeros = 0;
      for (const Imath::V3d& zero : inside) {
        const bool here = holds(box, cube(1e-12, zero)), near = box.intersects(zero);
        zeros += here;
        if (near) {
          EXPECT_NE(k.zeros, ZeroCount::kNone);
          EXPECT_FALSE(excludes_zero(field.model(box)));
        }
        EXPECT_TRUE(!here || k.enclosure.intersects(zero));
      }
      if (k.zeros == ZeroCount::kOne) {
        EXPECT_EQ(zeros, 1);
        found.push_back(k.enclosure);
      }
      if (k.zeros == ZeroCount::kUnknown)
        for (int i = 0; i < 8; ++i) stack.push_back(child_box(box, i));
    }
    EXPECT_EQ(found.size(), inside.size()) << trial;
    proved += found.size();
  }
  EXPECT_GT(proved, 300u);
}

TEST(Krawczyk, SingularHessiansAreLeftOpen) {
  // A double zero at the origin; a curve of zeros along x.
  const Cubic degenerate(Imath::V3d(0.0), {0, 1, -1, 0, 0, 0}, Imath::V3d(1, 0, 0));
  const Cubic ridge(Imath::V3d(0.0), {0, -1, -1, 0, 0, 0});
  for (const Cubic* field : {&degenerate, &ridge})
    for (const double half : {1e-9, 1e-3, 1.0}) {
      const Box box = cube(half);
      const Krawczyk k = krawczyk_on(*field, box);
      EXPECT_EQ(k.zeros, ZeroCount::kUnknown) << half;
      EXPECT_TRUE(holds(k.enclosure, box)) << half;
      EXPECT_FALSE(excludes_zero(field->model(box))) << half;
    }
  // Off the centre the Hessian can be inverted, and says nothing wrong.
  const Krawczyk k = krawczyk_on(degenerate, cube(0.1, Imath::V3d(0.05, 0.01, 0.02)));
  EXPECT_EQ(k.zeros, ZeroCount::kUnknown);
  EXPECT_TRUE(k.enclosure.intersects(Imath::V3d(0.0)));
}

TEST(Krawczyk, ModelsThatNothingIsKnownOfAreLeftOpen) {
  const double bad[] = {kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN(), 1e308};
  const LocalModel good = saddle_at(Imath::V3d(0.0)).model(cube(0.1, Imath::V3d(0.02)));
  ASSERT_EQ(krawczyk(good, gradient_at_centre(good)).zeros, ZeroCount::kOne);
  const auto expect_open = [](const LocalModel& model, const IntervalVector& g) {
    EXPECT_EQ(krawczyk(model, g).zeros, ZeroCount::kUnknown);
    EXPECT_FALSE(excludes_zero(model));
  };
  for (const double value : bad)
    for (const int c :
         {monomial::kX, monomial::kYY, monomial::kXZ, monomial::kZZZ, monomial::kXYZ}) {
      if (value == 1e308 && c == monomial::kX) continue;  // a steep slope, and no zero
      LocalModel model = good;
      model.c[static_cast<std::size_t>(c)] = value;
      expect_open(model, gradient_at_centre(model));
    }
  LocalModel errors = good;
  errors.hessian_error = kInfinity;
  expect_open(errors, gradient_at_centre(errors));
  errors = good;
  errors.gradient_error = Imath::V3d(kInfinity);
  expect_open(errors, gradient_at_centre(errors));
  IntervalVector whole{Interval::whole(), Interval::whole(), Interval::whole()};
  EXPECT_EQ(krawczyk(good, whole).zeros, ZeroCount::kUnknown);
}

// An error of the gradient widens the enclosure by as much as the zero may move.
TEST(Krawczyk, ErrorsOfTheGradientAreInTheEnclosure) {
  const Imath::V3d zero(0.1, 0.2, -0.1);
  Cubic field = saddle_at(zero);
  field.error = 0.01;
  const Krawczyk k = krawczyk_on(field, cube(0.5, zero));
  EXPECT_EQ(k.zeros, ZeroCount::kOne);
  for (int i = 0; i < 8; ++i) {
    const Imath::V3d push((i & 1) ? 0.01 : -0.01, (i & 2) ? 0.01 : -0.01, (i & 4) ? 0.01 : -0.01);
    // Where the gradient plus `push` vanishes: one Newton step from `zero`.
    const std::array<double, 6> h{2.0, -1.5, 0.7, 0.3, -0.2, 0.4};
    const Cubic moved(push - Cubic(Imath::V3d(0.0), h).jet(zero).gradient, h);
    const auto there = newton(moved, zero, cube(1.0), 5);
    ASSERT_TRUE(there.has_value());
    EXPECT_TRUE(k.enclosure.intersects(*there)) << push;
  }
  // Too large an error: the zero may be outside.
  field.error = 2.0;
  EXPECT_EQ(krawczyk_on(field, cube(0.5, zero)).zeros, ZeroCount::kUnknown);
}

// A Hessian that turns the axes: no derivative keeps its sign, the combination does.
TEST(Krawczyk, ExcludesMoreThanTheDerivativesOneByOne) {
  const Imath::V3d zero(1.5, 0.0, 0.0);
  const std::array<double, 6> h{1.0, 1.0, 1.0, 0.9, 0.0, 0.0};
  const Cubic field(-Cubic(Imath::V3d(0.0), h).jet(zero).gradient, h);
  const LocalModel model = field.model(cube(1.0));
  for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(model.gradient_range(axis).contains(0.0));
  EXPECT_TRUE(excludes_zero(model));
}

TEST(RefineZero, StaysInTheBoxThatTheFieldIsKnownIn) {
  // Far from the origin and near a wall of a small box; bounds so loose that small boxes prove
  // nothing, so that larger ones are tried.
  const Imath::V3d zero(1000.0, -2000.0, 500.0);
  Cubic field = saddle_at(zero);
  for (const double error : {0.0, 1e-9, 1e-7, 1e-6, 5e-6}) {
    field.error = error;
    const Box unique = cube(1e-4, zero + Imath::V3d(0.8e-4, -0.7e-4, 0.0));
    const Krawczyk k = krawczyk_on(field, unique);
    ASSERT_EQ(k.zeros, ZeroCount::kOne) << error;
    field.forget();
    std::uint64_t models = 0;
    const CertifiedZero found = refine_zero(field, unique, k.enclosure, models);
    EXPECT_TRUE(found.enclosure.intersects(zero)) << error;
    EXPECT_TRUE(holds(unique, found.enclosure)) << error;
    EXPECT_GT(models, 0u);
    EXPECT_TRUE(holds(unique, field.asked())) << error << field.asked().min << field.asked().max;
  }
}

}  // namespace
}  // namespace morsel::topology

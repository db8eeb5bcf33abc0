// SPDX-License-Identifier: Apache-2.0
// Local models of products and compositions against the functions themselves.
#include "hypertexture_geom/field/model_algebra.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/hypertexture_geom/soundness.h"
#include "tests/hypertexture_geom/test_fields.h"

namespace morsel::geom {
namespace {

using testing::count_outside;
using testing::FlushToZero;
using topology::Box;
using topology::Interval;
using topology::Jet;
using topology::LocalModel;
using topology::ScalarField;

// A field given by its jet and its model.
class Given final : public ScalarField {
 public:
  Given(std::function<Jet(const Imath::V3d&)> jet, std::function<LocalModel(const Box&)> model)
      : jet_(std::move(jet)), model_(std::move(model)) {}
  double value(const Imath::V3d& x) const override { return jet_(x).value; }
  Jet jet(const Imath::V3d& x) const override { return jet_(x); }
  LocalModel model(const Box& box) const override { return model_(box); }
  std::unique_ptr<ScalarField> restricted_to(const Box&) const override {
    return std::make_unique<Given>(*this);
  }

 private:
  std::function<Jet(const Imath::V3d&)> jet_;
  std::function<LocalModel(const Box&)> model_;
};

constexpr int kPair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

Jet chain(const Jet& f, double value, double slope, double bend) {
  Jet r;
  r.value = value;
  r.gradient = f.gradient * slope;
  for (int k = 0; k < 6; ++k)
    r.hessian[k] = bend * f.gradient[kPair[k][0]] * f.gradient[kPair[k][1]] + slope * f.hessian[k];
  return r;
}

Jet times(const Jet& f, const Jet& g) {
  Jet r;
  r.value = f.value * g.value;
  r.gradient = f.gradient * g.value + g.gradient * f.value;
  for (int k = 0; k < 6; ++k)
    r.hessian[k] = f.hessian[k] * g.value + g.hessian[k] * f.value +
                   f.gradient[kPair[k][0]] * g.gradient[kPair[k][1]] +
                   f.gradient[kPair[k][1]] * g.gradient[kPair[k][0]];
  return r;
}

std::shared_ptr<const Field> noise(int seed) {
  return testing::field_of(testing::eq13_json(2, seed, 0.5, 1.5));
}

// A univariate function with its derivatives and its model.
struct Function {
  const char* name;
  std::function<void(double, double (&)[3])> derivatives;  // of order 0 to 2
  std::function<UnivariateModel(double, Interval)> model;
};

std::vector<Function> functions() {
  std::vector<Function> all;
  all.push_back({"square",
                 [](double t, double(&d)[3]) {
                   d[0] = t * t;
                   d[1] = 2.0 * t;
                   d[2] = 2.0;
                 },
                 square_model});
  for (const double k : {1e-3, 0.05, 1.0}) {
    all.push_back({"smooth_abs",
                   [k](double t, double(&d)[3]) {
                     const double r = std::sqrt(t * t + k * k);
                     d[0] = t * t / (r + k);
                     d[1] = t / r;
                     d[2] = k * k / (r * r * r);
                   },
                   [k](double c, Interval t) { return smooth_abs_model(c, t, k); }});
    all.push_back({"smooth_sign",
                   [k](double t, double(&d)[3]) {
                     const double r = std::sqrt(t * t + k * k), r3 = r * r * r;
                     d[0] = t / r;
                     d[1] = k * k / r3;
                     d[2] = -3.0 * k * k * t / (r3 * r * r);
                   },
                   [k](double c, Interval t) { return smooth_sign_model(c, t, k); }});
  }
  all.push_back(
      {"exp", [](double t, double(&d)[3]) { d[0] = d[1] = d[2] = std::exp(t); }, exp_model});
  all.push_back({"smooth_step",
                 [](double t, double(&d)[3]) {
                   t = std::clamp(t, 0.0, 1.0);
                   d[0] = t * t * t * (10.0 + t * (6.0 * t - 15.0));
                   d[1] = 30.0 * t * t * (1.0 - t) * (1.0 - t);
                   d[2] = 60.0 * t * (1.0 - t) * (1.0 - 2.0 * t);
                 },
                 smooth_step_model});
  return all;
}

// Those of positive numbers.
std::vector<Function> positive_functions(double least) {
  std::vector<Function> all;
  all.push_back({"sqrt",
                 [](double t, double(&d)[3]) {
                   d[0] = std::sqrt(t);
                   d[1] = 0.5 / d[0];
                   d[2] = -0.25 / (d[0] * t);
                 },
                 [least](double c, Interval t) { return sqrt_model(c, t, least); }});
  all.push_back({"log",
                 [](double t, double(&d)[3]) {
                   d[0] = std::log(t);
                   d[1] = 1.0 / t;
                   d[2] = -1.0 / (t * t);
                 },
                 [least](double c, Interval t) { return log_model(c, t, least); }});
  for (const double p : {-1.3, 0.4, 2.7})
    all.push_back({"pow",
                   [p](double t, double(&d)[3]) {
                     d[0] = std::pow(t, p);
                     d[1] = p * std::pow(t, p - 1.0);
                     d[2] = p * (p - 1.0) * std::pow(t, p - 2.0);
                   },
                   [p, least](double c, Interval t) { return pow_model(c, t, p, least); }});
  return all;
}

void expect_model_holds(const Function& f, double centre, Interval range) {
  const UnivariateModel m = f.model(centre, range);
  for (int k = 0; k <= 20; ++k) {
    const double t = k == 20 ? range.hi : range.lo + (range.hi - range.lo) * k / 20.0;
    const double e = t - m.centre;
    double d[3];
    f.derivatives(t, d);
    const double p[3] = {m.a[0] + e * (m.a[1] + e * (m.a[2] + e * m.a[3])),
                         m.a[1] + e * (2.0 * m.a[2] + e * 3.0 * m.a[3]),
                         2.0 * m.a[2] + 6.0 * m.a[3] * e};
    const double sizes[3] = {
        std::abs(m.a[0]) + std::abs(e) * (std::abs(m.a[1]) + std::abs(e * m.a[2])),
        std::abs(m.a[1]) + std::abs(e) * (2.0 * std::abs(m.a[2]) + std::abs(e * m.a[3])),
        std::abs(m.a[2]) + std::abs(m.a[3] * e)};
    for (int i = 0; i < 3; ++i)
      EXPECT_LE(std::abs(d[i] - p[i]), m.error[i] + 1e-14 * (sizes[i] + std::abs(d[i])))
          << f.name << " derivative " << i << " at " << t << " of [" << range.lo << ", " << range.hi
          << "]";
    EXPECT_TRUE(m.value.lo <= d[0] + 1e-15 * std::abs(d[0]) &&
                d[0] <= m.value.hi + 1e-15 * std::abs(d[0]))
        << f.name;
    EXPECT_TRUE(m.slope.lo <= d[1] + 1e-15 * std::abs(d[1]) &&
                d[1] <= m.slope.hi + 1e-15 * std::abs(d[1]))
        << f.name;
    EXPECT_LE(std::abs(d[2]), m.bend * (1.0 + 1e-14)) << f.name;
  }
}

TEST(UnivariateModel, ErrorsHoldOnRandomIntervals) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const Function& f : functions())
    for (int n = 0; n < 3000; ++n) {
      const double width = std::ldexp(2.0, -static_cast<int>(random() % 24));
      const double c = n % 4 == 0 ? unit(random) * width : 2.0 * unit(random);
      const double lo = c - width * std::abs(unit(random)), hi = c + width * std::abs(unit(random));
      expect_model_holds(f, lo + (hi - lo) * std::abs(unit(random)), {lo, hi});
    }
  for (const double least : {1e-3, 0.5})
    for (const Function& f : positive_functions(least))
      for (int n = 0; n < 3000; ++n) {
        const double lo = least * std::exp(3.0 * std::abs(unit(random)));
        const double hi = lo * (1.0 + std::ldexp(8.0, -static_cast<int>(random() % 24)));
        expect_model_holds(f, lo + (hi - lo) * std::abs(unit(random)), {lo, hi});
      }
}

TEST(UnivariateModel, InfiniteRangesGiveWhatIsBounded) {
  const UnivariateModel m = smooth_abs_model(0.0, Interval::whole(), 0.1);
  EXPECT_TRUE(std::isinf(m.error[0]));
  EXPECT_NEAR(m.error[1], 1.0, 1e-9);
  EXPECT_NEAR(m.error[2], 10.0, 1e-6);
  const UnivariateModel s = smooth_sign_model(0.0, Interval::whole(), 0.1);
  EXPECT_NEAR(s.error[0], 1.0, 1e-9);
}

TEST(ModelAlgebra, ProductsAndCompositionsHold) {
  for (const bool flush : {false, true}) {
    const FlushToZero mode(flush);
    std::mt19937_64 random(21);
    const auto f = noise(1), g = noise(2);
    const Given by([&](const Imath::V3d& x) { return times(f->jet(x), g->jet(x)); },
                   [&](const Box& b) { return product(f->model(b), g->model(b)); });
    const auto outside = count_outside(by, random, 200, 16);
    EXPECT_EQ(outside.total(), 0) << outside.text();
    for (const Function& phi : functions()) {
      const Given composed(
          [&](const Imath::V3d& x) {
            const Jet inner = f->jet(x);
            double d[3];
            phi.derivatives(inner.value, d);
            return chain(inner, d[0], d[1], d[2]);
          },
          [&](const Box& b) {
            const LocalModel inner = f->model(b);
            return compose(inner, phi.model(inner.c[0], inner.range()));
          });
      const auto composed_outside = count_outside(composed, random, 200, 16);
      EXPECT_EQ(composed_outside.total(), 0) << phi.name << ": " << composed_outside.text();
    }
    // sqrt(f^2 + 1/4) and its like.
    for (const Function& phi : positive_functions(0.25)) {
      const Given composed(
          [&](const Imath::V3d& x) {
            Jet inner = times(f->jet(x), f->jet(x));
            inner.value += 0.25;
            double d[3];
            phi.derivatives(inner.value, d);
            return chain(inner, d[0], d[1], d[2]);
          },
          [&](const Box& b) {
            const LocalModel h = f->model(b);
            const LocalModel inner = add_constant(product(h, h), 0.25);
            return compose(inner, phi.model(inner.c[0], inner.range()));
          });
      const auto composed_outside = count_outside(composed, random, 200, 16);
      EXPECT_EQ(composed_outside.total(), 0) << phi.name << ": " << composed_outside.text();
    }
  }
}

TEST(ModelAlgebra, AWeakenedBoundIsNoticed) {
  std::mt19937_64 random(22);
  const auto f = noise(1);
  const Given composed(
      [&](const Imath::V3d& x) {
        const Jet inner = f->jet(x);
        const double r = std::sqrt(inner.value * inner.value + 0.01);
        return chain(inner, r - 0.1, inner.value / r, 0.01 / (r * r * r));
      },
      [&](const Box& b) {
        const LocalModel inner = f->model(b);
        return compose(inner, smooth_abs_model(inner.c[0], inner.range(), 0.1));
      });
  const auto outside = count_outside(composed, random, 600, 24, 0.3);
  EXPECT_GT(outside.value, 0);
  EXPECT_GT(outside.gradient, 0);
}

TEST(ModelAlgebra, Quadratics) {
  std::mt19937_64 random(23);
  const Imath::V3d origin(0.3, -1.7, 0.9), b(0.5, -2.0, 1.0);
  const double a[6] = {1.0, -2.0, 0.5, 0.7, -0.3, 1.1};
  const Given q(
      [&](const Imath::V3d& x) {
        const Imath::V3d d = x - origin;
        const Imath::V3d ad(a[0] * d.x + a[3] * d.y + a[4] * d.z,
                            a[3] * d.x + a[1] * d.y + a[5] * d.z,
                            a[4] * d.x + a[5] * d.y + a[2] * d.z);
        Jet r;
        r.value = 0.25 + d.dot(b + ad);
        r.gradient = b + ad * 2.0;
        for (int k = 0; k < 6; ++k) r.hessian[k] = 2.0 * a[k];
        return r;
      },
      [&](const Box& box) { return quadratic_model(box, origin, 0.25, b, a); });
  EXPECT_EQ(count_outside(q, random, 500, 16).total(), 0);
  const LocalModel m = quadratic_model(Box(Imath::V3d(-1.0), Imath::V3d(1.0)), origin, 0.25, b, a);
  EXPECT_LT(m.value_error, 2e-12);  // exact but for rounding
}

TEST(ModelAlgebra, SumsProductsOfCoordinatesAreExact) {
  const Box box(Imath::V3d(-1.0, 2.0, 0.5), Imath::V3d(1.0, 3.0, 4.5));
  const LocalModel x = coordinate_model(box, 0), y = coordinate_model(box, 1),
                   z = coordinate_model(box, 2);
  // 2 x y z - 3 at (0.25, 2.75, 1.5).
  const LocalModel m = add_constant(scale(product(product(x, y), z), 2.0), -3.0);
  EXPECT_NEAR(m.value_at(Imath::V3d(0.25, 2.75, 1.5) - m.centre), 2.0 * 0.25 * 2.75 * 1.5 - 3.0,
              1e-13);
  EXPECT_LT(m.value_error, 2e-11);
  EXPECT_LT(m.hessian_error, 1e-10);
  const LocalModel zero = subtract(product(x, y), product(y, x));
  EXPECT_LT(zero.range().magnitude(), 1e-12);
}

TEST(ModelAlgebra, UnknownDerivativesLeaveTheValueBounded) {
  LocalModel m = constant_model(Box(Imath::V3d(-1.0), Imath::V3d(1.0)), 0.25, 0.5);
  m.gradient_error = Imath::V3d(std::numeric_limits<double>::infinity());
  m.hessian_error = std::numeric_limits<double>::infinity();
  const LocalModel square = product(m, m);
  EXPECT_NEAR(square.value_error, 0.5, 1e-9);  // 2 * 0.25 * 0.5 + 0.25
  EXPECT_TRUE(std::isinf(square.gradient_error.x));
  const LocalModel absolute = compose(m, smooth_abs_model(m.c[0], m.range(), 0.01));
  EXPECT_TRUE(std::isfinite(absolute.value_error));
  EXPECT_LT(absolute.range().hi, 0.8);
  EXPECT_TRUE(std::isinf(absolute.hessian_error));
}

}  // namespace
}  // namespace morsel::geom

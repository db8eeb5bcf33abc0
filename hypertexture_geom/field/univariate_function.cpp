// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/univariate_function.h"

#include <algorithm>
#include <cmath>

#include "hypertexture_geom/field/jet_algebra.h"
#include "hypertexture_geom/field/model_algebra.h"
#include "hypertexture_geom/field/operation.h"

namespace morsel::geom {
namespace {

using topology::Box;
using topology::Interval;
using topology::Jet;
using topology::LocalModel;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Applied {
  std::shared_ptr<const UnivariateFunction> phi;

  template <class F>
  double value(const F& f, const Imath::V3d& x) const {
    return phi->value(f[0]->value(x));
  }

  template <class F>
  Jet jet(const F& f, const Imath::V3d& x) const {
    const Jet inner = f[0]->jet(x);
    double d[3];
    phi->derivatives(inner.value, d);
    return jets::compose(d[0], d[1], d[2], inner);
  }

  template <class F>
  LocalModel model(const F& f, const Box& box) const {
    const LocalModel inner = f[0]->model(box);
    return compose(inner, phi->model(inner.c[0], inner.range()));
  }

  template <class F>
  RestrictedFields restricted(const F& f, const Box& box) const {
    RestrictedFields r;
    r.push_back(f[0]->restricted_to(box));
    return r;
  }

  template <class F>
  TapeValue emit(const F& f, TapeBuilder& tape) const {
    return phi->emit(tape, tape.field(*f[0]));
  }

  Interval expected_range(const Expressions& f) const { return phi->range(f[0]->expected_range()); }

  std::optional<Box> superlevel_box(const Expressions& f, double level) const {
    if (expected_range(f).hi < level) return Box();
    const double least = phi->least_argument(level);
    if (least == -kInfinity) return std::nullopt;
    return f[0]->superlevel_box(least);
  }
};

class Affine final : public UnivariateFunction {
 public:
  Affine(double factor, double offset) : factor_(factor), offset_(offset) {}

  double value(double t) const override { return factor_ * t + offset_; }
  void derivatives(double t, double (&d)[3]) const override {
    d[0] = value(t);
    d[1] = factor_;
    d[2] = 0.0;
  }
  UnivariateModel model(double centre, Interval range) const override {
    const Interval factor = Interval::point(factor_), offset = Interval::point(offset_);
    const Interval at_centre = factor * Interval::point(centre) + offset;
    UnivariateModel m;
    m.centre = centre;
    m.a[0] = at_centre.middle();
    m.a[1] = factor_;
    m.error[0] = at_centre.width();
    m.value = factor * range + offset;
    m.slope = factor;
    m.bend = 0.0;
    return m;
  }
  Interval range(Interval t) const override {
    if (factor_ == 0.0) return Interval::point(offset_);
    const double a = value(t.lo), b = value(t.hi);
    return {std::min(a, b), std::max(a, b)};
  }
  double least_argument(double level) const override {
    if (!(factor_ > 0.0)) return -kInfinity;
    const double t = (level - offset_) / factor_;
    return t - 1e-12 * (std::abs(t) + std::abs(offset_ / factor_));
  }
  TapeValue emit(TapeBuilder& tape, const TapeValue& t) const override {
    return tape.multiply_add(t, factor_, offset_);
  }

 private:
  double factor_, offset_;
};

class SmoothStep final : public UnivariateFunction {
 public:
  double value(double t) const override {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * t * (10.0 + t * (6.0 * t - 15.0));
  }
  void derivatives(double t, double (&d)[3]) const override {
    d[0] = value(t);
    t = std::clamp(t, 0.0, 1.0);
    const double rest = t * (1.0 - t);
    d[1] = 30.0 * rest * rest;
    d[2] = 60.0 * rest * (1.0 - 2.0 * t);
  }
  UnivariateModel model(double centre, Interval range) const override {
    return smooth_step_model(centre, range);
  }
  Interval range(Interval t) const override { return {value(t.lo), value(t.hi)}; }
  double least_argument(double level) const override {
    if (level <= 0.0) return -kInfinity;
    if (level > 1.0) return kInfinity;
    double lo = 0.0, hi = 1.0;  // value(lo) < level
    for (int i = 0; i < 60; ++i) (value(0.5 * (lo + hi)) < level ? lo : hi) = 0.5 * (lo + hi);
    return lo - 1e-12;
  }
  TapeValue emit(TapeBuilder& tape, const TapeValue& t) const override {
    return tape.smooth_step(t);
  }
};

class HyperbolaFunction final : public UnivariateFunction {
 public:
  explicit HyperbolaFunction(const Hyperbola& h) : h_(h) {}

  double value(double t) const override {
    const double u = t - h_.bend_at, r = std::sqrt(u * u + h_.width * h_.width);
    return h_.constant + h_.slope * u + h_.absolute * (u * (u / (r + h_.width))) +
           h_.sign * (u / r);
  }
  void derivatives(double t, double (&d)[3]) const override {
    const double u = t - h_.bend_at, k = h_.width, i = 1.0 / std::sqrt(u * u + k * k);
    const double s1 = u * i, s2 = k * i * k * i * i, s3 = -3.0 * s1 * i * s2;
    d[0] = value(t);
    d[1] = h_.slope + h_.absolute * s1 + h_.sign * s2;
    d[2] = h_.absolute * s2 + h_.sign * s3;
  }
  UnivariateModel model(double centre, Interval range) const override {
    return univariate_model(centre, range, [this](Interval t) { return ranges(t); });
  }
  Interval range(Interval t) const override {
    if (increasing()) return {end(t.lo), end(t.hi)};
    return ranges(t)[0];
  }
  double least_argument(double level) const override {
    if (!increasing() || !std::isfinite(level)) return increasing() ? level : -kInfinity;
    double lo = h_.bend_at - h_.width, hi = h_.bend_at + h_.width;
    while (value(lo) >= level && std::isfinite(lo)) lo = h_.bend_at - 2.0 * (h_.bend_at - lo);
    while (value(hi) < level && std::isfinite(hi)) hi = h_.bend_at + 2.0 * (hi - h_.bend_at);
    for (int i = 0; i < 200; ++i) (value(0.5 * (lo + hi)) < level ? lo : hi) = 0.5 * (lo + hi);
    return lo - 1e-12 * (std::abs(lo) + h_.width);
  }
  TapeValue emit(TapeBuilder& tape, const TapeValue& t) const override {
    const TapeValue u = h_.bend_at == 0.0 ? t : tape.multiply_add(t, 1.0, -h_.bend_at);
    TapeValue sum =
        h_.slope == 0.0 ? tape.constant(h_.constant) : tape.multiply_add(u, h_.slope, h_.constant);
    if (h_.absolute != 0.0)
      sum = tape.add(sum, tape.multiply_add(tape.smooth_abs(u, h_.width), h_.absolute, 0.0));
    if (h_.sign != 0.0)
      sum = tape.add(sum, tape.multiply_add(tape.soft_sign(u, h_.width), h_.sign, 0.0));
    return sum;
  }

  DerivativeRanges ranges(Interval t) const {
    const auto point = [](double x) { return Interval::point(x); };
    const Interval u = t - point(h_.bend_at);
    const std::array<Interval, 7> s = smooth_abs_ranges(u, h_.width);
    DerivativeRanges d;
    // 0 times an infinite end is undefined: terms without weight are left out.
    if (h_.slope != 0.0) {
      d[0] = point(h_.slope) * u;
      d[1] = point(h_.slope);
    }
    d[0] = d[0] + point(h_.constant);
    for (std::size_t n = 0; n < d.size(); ++n) {
      if (h_.absolute != 0.0) d[n] = d[n] + point(h_.absolute) * s[n];
      if (h_.sign != 0.0) d[n] = d[n] + point(h_.sign) * s[n + 1];
    }
    return d;
  }

 private:
  // Slopes lie between those at the bend and far from it (sign's is a bump).
  bool increasing() const {
    return h_.slope - std::abs(h_.absolute) > 0.0 &&
           h_.slope - std::abs(h_.absolute) + h_.sign / h_.width > 0.0;
  }
  double end(double t) const { return std::isinf(t) ? t : value(t); }

  Hyperbola h_;
};

class SquaredHyperbola final : public UnivariateFunction {
 public:
  SquaredHyperbola(const Hyperbola& h, double factor) : root_(h), factor_(factor) {}

  double value(double t) const override {
    const double r = root_.value(t);
    return factor_ * r * r;
  }
  void derivatives(double t, double (&d)[3]) const override {
    double r[3];
    root_.derivatives(t, r);
    d[0] = factor_ * r[0] * r[0];
    d[1] = factor_ * 2.0 * r[0] * r[1];
    d[2] = factor_ * 2.0 * (r[0] * r[2] + r[1] * r[1]);
  }
  UnivariateModel model(double centre, Interval range) const override {
    return univariate_model(centre, range, [this](Interval t) { return ranges(t); });
  }
  Interval range(Interval t) const override { return ranges(t)[0]; }
  double least_argument(double) const override { return -kInfinity; }
  TapeValue emit(TapeBuilder& tape, const TapeValue& t) const override {
    const TapeValue r = root_.emit(tape, t);
    return tape.multiply_add(tape.multiply(r, r), factor_, 0.0);
  }

 private:
  // Leibniz' rule.
  DerivativeRanges ranges(Interval t) const {
    const auto point = [](double x) { return Interval::point(x); };
    const DerivativeRanges r = root_.ranges(t);
    const Interval f = point(factor_), two = point(2.0) * f;
    return {f * topology::square(r[0]),
            two * r[0] * r[1],
            two * (r[0] * r[2] + topology::square(r[1])),
            two * (r[0] * r[3] + point(3.0) * r[1] * r[2]),
            two * (r[0] * r[4] + point(4.0) * r[1] * r[3] + point(3.0) * topology::square(r[2])),
            two * (r[0] * r[5] + point(5.0) * r[1] * r[4] + point(10.0) * r[2] * r[3])};
  }

  HyperbolaFunction root_;
  double factor_;
};

}  // namespace

std::unique_ptr<Expression> make_univariate(std::shared_ptr<const UnivariateFunction> phi,
                                            std::shared_ptr<const Expression> f) {
  return std::make_unique<OperationExpression<Applied>>(Applied{std::move(phi)},
                                                        Expressions{std::move(f)});
}

std::shared_ptr<const UnivariateFunction> affine_function(double factor, double offset) {
  return std::make_shared<Affine>(factor, offset);
}

std::shared_ptr<const UnivariateFunction> smooth_step_function() {
  return std::make_shared<SmoothStep>();
}

std::shared_ptr<const UnivariateFunction> hyperbola_function(const Hyperbola& parameters) {
  return std::make_shared<HyperbolaFunction>(parameters);
}

std::shared_ptr<const UnivariateFunction> squared_hyperbola_function(const Hyperbola& parameters,
                                                                     double factor) {
  return std::make_shared<SquaredHyperbola>(parameters, factor);
}

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "hypertexture_geom/field/expression.h"
#include "hypertexture_geom/field/jet_algebra.h"
#include "hypertexture_geom/field/model_algebra.h"
#include "hypertexture_geom/field/tape_builder.h"

// Closed formulas written once and evaluated in four arithmetics: values (double), derivatives
// (Jet), rigorous local models (LocalModel) and vector instructions (TapeValue).
namespace morsel::geom {

// constant + sum_k (rows[k] . (x - origin))^2. A sum of squares rather than a matrix: it cannot
// come out negative, however far from the origin.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the copy's __i0.
struct SumOfSquares {
  Imath::V3d origin{0.0};
  double constant = 0.0;
  Imath::V3d rows[3] = {Imath::V3d(0.0), Imath::V3d(0.0), Imath::V3d(0.0)};
};

// The operations that formulas are made of, for each arithmetic (model_algebra.h has add, scale and
// add_constant of models).
inline double add(double a, double b) { return a + b; }
inline double scale(double a, double factor) { return factor * a; }
inline double add_constant(double a, double c) { return a + c; }
inline topology::Jet add(const topology::Jet& a, const topology::Jet& b) {
  return jets::operator+(a, b);
}
inline topology::Jet scale(const topology::Jet& a, double factor) {
  return jets::operator*(factor, a);
}
inline topology::Jet add_constant(topology::Jet a, double c) {
  a.value += c;
  return a;
}

inline TapeValue add(const TapeValue& a, const TapeValue& b) { return a.builder->add(a, b); }
inline TapeValue scale(const TapeValue& a, double factor) {
  return a.builder->multiply_add(a, factor, 0.0);
}
inline TapeValue add_constant(const TapeValue& a, double c) {
  return a.builder->multiply_add(a, 1.0, c);
}

inline double square(double a) { return a * a; }
inline topology::Jet square(const topology::Jet& a) { return jets::operator*(a, a); }
inline topology::LocalModel square(const topology::LocalModel& a) { return product(a, a); }

inline TapeValue square(const TapeValue& a) { return a.builder->multiply(a, a); }

// sqrt(a) where a >= least > 0 is known.
inline double root(double a, double /*least*/) { return std::sqrt(a); }
inline topology::Jet root(const topology::Jet& a, double /*least*/) {
  const double r = std::sqrt(a.value);
  return jets::compose(r, 0.5 / r, -0.25 / (r * a.value), a);
}
inline topology::LocalModel root(const topology::LocalModel& a, double least) {
  return compose(a, sqrt_model(a.c[0], a.range(), least * (1.0 - 1e-14)));
}

inline TapeValue root(const TapeValue& a, double least) { return a.builder->root(a, least); }

// phi(f) for f = linear(...), without the detour over general series: phi is modelled about f.c[0]
// on f.range(). `extra` bounds what else f may be off by.
topology::LocalModel compose_linear(const topology::LocalModel& f, const UnivariateModel& phi,
                                    double extra = 0.0);

// sqrt(a^2 + k^2) - k, without cancellation near a = 0.
inline double smooth_abs(double a, double k) { return a * a / (std::sqrt(a * a + k * k) + k); }
inline topology::Jet smooth_abs(const topology::Jet& a, double k) {
  const double t = a.value, r = std::sqrt(t * t + k * k), i = 1.0 / r;
  return jets::compose(smooth_abs(t, k), t * i, k * i * k * i * i, a);
}
inline topology::LocalModel smooth_abs(const topology::LocalModel& a, double k) {
  return compose(a, smooth_abs_model(a.c[0], a.range(), k));
}

inline TapeValue smooth_abs(const TapeValue& a, double k) { return a.builder->smooth_abs(a, k); }

// Functions of the position to begin a formula with, at a point or on a box.
class PointScope {
 public:
  explicit PointScope(const Imath::V3d& x) : x_(x) {}
  // row . (x - origin)
  double linear(const Imath::V3d& row, const Imath::V3d& origin) const {
    return row.dot(x_ - origin);
  }
  double squares(const SumOfSquares& q) const {
    const Imath::V3d d = x_ - q.origin;
    return q.constant + square(q.rows[0].dot(d)) + square(q.rows[1].dot(d)) +
           square(q.rows[2].dot(d));
  }

 private:
  Imath::V3d x_;
};

class JetScope {
 public:
  explicit JetScope(const Imath::V3d& x) : x_(x) {}
  topology::Jet linear(const Imath::V3d& row, const Imath::V3d& origin) const {
    topology::Jet jet;
    jet.value = row.dot(x_ - origin);
    jet.gradient = row;
    return jet;
  }
  topology::Jet squares(const SumOfSquares& q) const {
    topology::Jet jet = jets::constant(q.constant);
    for (const Imath::V3d& row : q.rows) jet = add(jet, square(linear(row, q.origin)));
    return jet;
  }

 private:
  Imath::V3d x_;
};

class TapeScope {
 public:
  explicit TapeScope(TapeBuilder& tape) : tape_(tape) {}
  TapeValue linear(const Imath::V3d& row, const Imath::V3d& origin) const {
    return tape_.linear(row, origin);
  }
  TapeValue squares(const SumOfSquares& q) const {
    return tape_.squares(q.rows, q.origin, q.constant);
  }

 private:
  TapeBuilder& tape_;
};

class ModelScope {
 public:
  explicit ModelScope(const topology::Box& box) : box_(box) {}
  topology::LocalModel linear(const Imath::V3d& row, const Imath::V3d& origin) const {
    return quadratic_model(box_, origin, 0.0, row, {0.0, 0.0, 0.0, 0.0, 0.0, 0.0});
  }
  topology::LocalModel squares(const SumOfSquares& q) const;

 private:
  topology::Box box_;
};

// smooth_abs(row . (x - origin), k).
template <class Scope>
auto smooth_distance(const Scope& at, const Imath::V3d& row, const Imath::V3d& origin, double k) {
  return smooth_abs(at.linear(row, origin), k);
}
inline topology::LocalModel smooth_distance(const ModelScope& at, const Imath::V3d& row,
                                            const Imath::V3d& origin, double k) {
  const topology::LocalModel u = at.linear(row, origin);
  return compose_linear(u, smooth_abs_model(u.c[0], u.range(), k));
}

// A density given by a formula: a class with
//   template <class Scope> auto operator()(const Scope&) const
//   topology::Interval range() const                              as Expression::expected_range
//   std::optional<topology::Box> superlevel_box(double) const     as Expression::superlevel_box
template <class Formula>
class FormulaDensity final : public Expression {
 public:
  explicit FormulaDensity(const Formula& formula) : formula_(formula) {}

  double value(const Imath::V3d& x) const override { return formula_(PointScope(x)); }
  topology::Jet jet(const Imath::V3d& x) const override { return formula_(JetScope(x)); }
  topology::LocalModel model(const topology::Box& box) const override {
    return formula_(ModelScope(box));
  }
  std::unique_ptr<ScalarField> restricted_to(const topology::Box&) const override {
    return std::make_unique<FormulaDensity>(*this);
  }
  TapeValue emit(TapeBuilder& tape) const override { return formula_(TapeScope(tape)); }
  topology::Interval expected_range() const override { return formula_.range(); }
  std::optional<topology::Box> superlevel_box(double level) const override {
    return formula_.superlevel_box(level);
  }

 private:
  Formula formula_;
};

// The box centre -+ reach, a little enlarged against rounding.
inline topology::Box box_about(const Imath::V3d& centre, const Imath::V3d& reach) {
  topology::Box box;
  for (int i = 0; i < 3; ++i) {
    const double slack = 1e-12 * (std::abs(centre[i]) + reach[i]) + 1e-300;
    box.min[i] = centre[i] - reach[i] - slack;
    box.max[i] = centre[i] + reach[i] + slack;
  }
  return box;
}

// Two unit vectors at right angles to the unit vector `axis` and to one another.
struct Perpendiculars {
  Imath::V3d u, v;
};
inline Perpendiculars perpendiculars(const Imath::V3d& axis) {
  int thinnest = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(axis[i]) < std::abs(axis[thinnest])) thinnest = i;
  Imath::V3d e(0.0);
  e[thinnest] = 1.0;
  const Imath::V3d u = axis.cross(e).normalized();
  return {u, axis.cross(u)};
}

}  // namespace morsel::geom

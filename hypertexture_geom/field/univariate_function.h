// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hypertexture_geom/field/expression.h"
#include "hypertexture_geom/field/univariate_model.h"

namespace morsel::geom {

// phi: R -> R, twice continuously differentiable, applied to an expression. Immutable.
class UnivariateFunction {
 public:
  virtual ~UnivariateFunction() = default;

  virtual double value(double t) const = 0;
  // phi, phi' and phi'' at t.
  virtual void derivatives(double t, double (&d)[3]) const = 0;
  virtual UnivariateModel model(double centre, topology::Interval range) const = 0;

  // The values on `t`, whose ends may be infinite.
  virtual topology::Interval range(topology::Interval t) const = 0;

  // A number that phi(t) >= level implies t to be at least: -infinity when nothing follows.
  virtual double least_argument(double level) const = 0;

  // Writes phi(t) onto a tape.
  virtual TapeValue emit(TapeBuilder& tape, const TapeValue& t) const = 0;
};

// phi(f(x))
std::unique_ptr<Expression> make_univariate(std::shared_ptr<const UnivariateFunction> phi,
                                            std::shared_ptr<const Expression> f);

// phi(t) = factor t + offset
std::shared_ptr<const UnivariateFunction> affine_function(double factor, double offset);

// Perlin's smooth step between 0 at t <= 0 and 1 at t >= 1.
std::shared_ptr<const UnivariateFunction> smooth_step_function();

// What bends about one point, with constant slopes far from it: with u = t - bend_at and the smooth
// absolute value s(u) = sqrt(u^2 + width^2) - width,
//   phi(t) = constant + slope u + absolute s(u) + sign u / sqrt(u^2 + width^2).
struct Hyperbola {
  double bend_at = 0.0;
  double width = 1.0;  // > 0
  double constant = 0.0;
  double slope = 0.0;
  double absolute = 0.0;
  double sign = 0.0;
};
std::shared_ptr<const UnivariateFunction> hyperbola_function(const Hyperbola& parameters);

// phi(t)^2 for such a phi.
std::shared_ptr<const UnivariateFunction> squared_hyperbola_function(const Hyperbola& parameters,
                                                                     double factor);

}  // namespace morsel::geom

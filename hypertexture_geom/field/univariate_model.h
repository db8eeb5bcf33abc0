// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <limits>

#include "topology/interval.h"

namespace morsel::geom {

// A function phi of one variable t on an interval, replaced by the cubic
// a[0] + a[1] e + a[2] e^2 + a[3] e^3 with e = t - centre. On the interval phi and its first two
// derivatives are off by at most error[0], error[1], error[2], rounding of the coefficients
// included.
struct UnivariateModel {
  double centre = 0.0;
  double a[4] = {};
  double error[3] = {};
  // Enclosures of phi and phi' and a bound on |phi''| on the interval: where the cubic says less
  // than the plain range, compositions fall back to it.
  topology::Interval value = topology::Interval::whole();
  topology::Interval slope = topology::Interval::whole();
  double bend = std::numeric_limits<double>::infinity();
};

// Models of common functions about `centre` on `range` (which may be infinite; `centre` need not be
// its middle). All derivatives named are with respect to t.

// t^2, exactly.
UnivariateModel square_model(double centre, topology::Interval range);

// sqrt(t) for t that are known to be at least `least` > 0, even where `range` says less.
UnivariateModel sqrt_model(double centre, topology::Interval range, double least);

// The smooth absolute value sqrt(t^2 + k^2) - k, k > 0: 0 at 0, convex, slope within (-1, 1),
// second derivative in (0, 1 / k], below |t| by at most k.
UnivariateModel smooth_abs_model(double centre, topology::Interval range, double k);

// The smooth sign t / sqrt(t^2 + k^2), the derivative of the former.
UnivariateModel smooth_sign_model(double centre, topology::Interval range, double k);

// exp(t) and, for t known to be at least `least` > 0, log(t) and t^p.
UnivariateModel exp_model(double centre, topology::Interval range);
UnivariateModel log_model(double centre, topology::Interval range, double least);
UnivariateModel pow_model(double centre, topology::Interval range, double p, double least);

// Perlin's smooth step 6 t^5 - 15 t^4 + 10 t^3 between 0 at t <= 0 and 1 at t >= 1.
UnivariateModel smooth_step_model(double centre, topology::Interval range);

// What is needed to model any other function of class C^4 or better: enclosures at the middle of
// `range` (range.middle()) of the function and its derivatives up to the fourth, bounds over the
// range on the fifth derivative (or infinity) and on the fourth's distance from its value in the
// middle (or infinity; the better of both is used), and the plain ranges.
struct TaylorData {
  topology::Interval at_middle[5];
  double fifth = std::numeric_limits<double>::infinity();
  double fourth_deviation = std::numeric_limits<double>::infinity();
  topology::Interval value = topology::Interval::whole();
  topology::Interval slope = topology::Interval::whole();
  topology::Interval bend = topology::Interval::whole();
};
UnivariateModel univariate_model(double centre, topology::Interval range, const TaylorData& data);

// The same for a function whose enclosures on any interval are known: f(t) are those of the
// function and its derivatives up to the fifth.
using DerivativeRanges = std::array<topology::Interval, 6>;
UnivariateModel univariate_model(double centre, topology::Interval range,
                                 const std::function<DerivativeRanges(topology::Interval)>& f);

// Enclosures on `t` of the smooth absolute value and its derivatives up to the sixth.
std::array<topology::Interval, 7> smooth_abs_ranges(topology::Interval t, double k);

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/univariate_model.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace morsel::geom {
namespace {

using topology::Interval;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kUp = 1.0 + 1e-13;  // covers the rounding of a bound made of a few operations
constexpr double kUnderflow = 1e-290;

// A polynomial about `origin` with interval coefficients and errors.
struct Candidate {
  Interval b[4] = {};
  double error[3] = {};
};

double or_infinity(double x) { return x >= 0.0 ? x : kInfinity; }

// Re-expands about `centre`; the coefficients' widths join the errors.
UnivariateModel shifted(const Candidate& p, double origin, double centre, Interval range) {
  Interval a[4] = {p.b[0], p.b[1], p.b[2], p.b[3]};
  if (centre != origin) {
    const Interval s = Interval::point(centre) - Interval::point(origin),
                   two = Interval::point(2.0), three = Interval::point(3.0);
    a[2] = p.b[2] + three * s * p.b[3];
    a[1] = p.b[1] + s * (two * p.b[2] + three * s * p.b[3]);
    a[0] = p.b[0] + s * (p.b[1] + s * (p.b[2] + s * p.b[3]));
  }
  UnivariateModel m;
  m.centre = centre;
  double width[4];
  bool finite = true;
  for (int i = 0; i < 4; ++i) {
    m.a[i] = a[i].middle();
    width[i] = std::max(a[i].hi - m.a[i], m.a[i] - a[i].lo);
    finite = finite && std::isfinite(m.a[i]) && std::isfinite(width[i]);
  }
  if (!finite) {
    std::fill(m.a, m.a + 4, 0.0);
    std::fill(m.error, m.error + 3, kInfinity);
    return m;
  }
  const double e = std::max(range.hi - centre, centre - range.lo);
  // A coefficient that is exact contributes nothing, however wide the range.
  const auto times = [](double x, double y) { return x == 0.0 || y == 0.0 ? 0.0 : x * y; };
  const double extra[3] = {width[0] + times(e, width[1] + times(e, width[2] + times(e, width[3]))),
                           width[1] + times(e, 2.0 * width[2] + times(e, 3.0 * width[3])),
                           2.0 * width[2] + times(e, 6.0 * width[3])};
  for (int i = 0; i < 3; ++i) m.error[i] = or_infinity((p.error[i] + extra[i]) * kUp + kUnderflow);
  return m;
}

Interval constant(double x) { return Interval::point(x); }

// Keeps the better model of two. Errors of the value and of the slope count alike: the slope's for
// as much as it can add up to over half the interval's half length.
class Best {
 public:
  Best(double centre, Interval range)
      : centre_(centre), range_(range), reach_(0.25 * (range.hi - range.lo)) {}

  void offer(const Candidate& p, double origin) {
    const UnivariateModel m = shifted(p, origin, centre_, range_);
    const double mine = score(m), other = score(model_);
    if (empty_ || mine < other || (!(other < mine) && m.error[0] < model_.error[0])) model_ = m;
    empty_ = false;
  }

  const UnivariateModel& model() const { return model_; }

 private:
  double score(const UnivariateModel& m) const {
    return or_infinity(m.error[0] + reach_ * m.error[1]);
  }

  double centre_;
  Interval range_;
  double reach_;
  UnivariateModel model_;
  bool empty_ = true;
};

void offer_plain_and_taylor(const TaylorData& data, double centre, Interval range, Best& best) {
  const double bend = data.bend.magnitude();
  const auto offer = [&](const Candidate& p, double origin) { best.offer(p, origin); };
  // The plain range.
  {
    Candidate p;
    p.b[0] = constant(std::isfinite(data.value.width()) ? data.value.middle() : 0.0);
    p.error[0] = std::max(data.value.hi - p.b[0].lo, p.b[0].lo - data.value.lo) * kUp;
    p.error[1] = data.slope.magnitude();
    p.error[2] = bend;
    offer(p, centre);
  }
  const double middle = range.middle();
  const double e = std::max(range.hi - middle, middle - range.lo) * kUp;
  if (std::isfinite(e)) {
    // A line with the middle slope.
    Candidate line;
    line.b[0] = data.at_middle[0];
    line.b[1] = constant(data.slope.middle());
    line.error[1] = std::max(data.slope.hi - line.b[1].lo, line.b[1].lo - data.slope.lo) * kUp;
    line.error[0] = line.error[1] * e;
    line.error[2] = bend;
    if (std::isfinite(line.b[1].lo)) offer(line, middle);
    // A parabola with the middle second derivative and the slope it has in the middle.
    Candidate parabola;
    parabola.b[0] = data.at_middle[0];
    parabola.b[1] = data.at_middle[1];
    parabola.b[2] = constant(0.5 * data.bend.middle());
    parabola.error[2] =
        std::max(data.bend.hi - data.bend.middle(), data.bend.middle() - data.bend.lo) * kUp;
    parabola.error[1] = parabola.error[2] * e;
    parabola.error[0] = 0.5 * parabola.error[2] * e * e;
    if (std::isfinite(parabola.b[2].lo)) offer(parabola, middle);
    // Taylor's polynomial of degree 4 with e^4 replaced by 3/2 E^2 e^2 - 9/32 E^4 (within 9/32 E^4,
    // slope E^3, second derivative 9 E^2).
    Candidate cubic;
    const Interval fourth = data.at_middle[4] / constant(24.0),
                   square = topology::square(constant(e));
    cubic.b[0] = data.at_middle[0] - constant(9.0 / 32.0) * fourth * square * square;
    cubic.b[1] = data.at_middle[1];
    cubic.b[2] = data.at_middle[2] / constant(2.0) + constant(1.5) * fourth * square;
    cubic.b[3] = data.at_middle[3] / constant(6.0);
    const double f = fourth.magnitude();
    const double by_fifth = data.fifth * e / 5.0, d = std::min(by_fifth, data.fourth_deviation);
    cubic.error[0] = (9.0 / 32.0 * f + d / 24.0) * e * e * e * e;
    cubic.error[1] = (f + std::min(data.fifth * e / 4.0, data.fourth_deviation) / 6.0) * e * e * e;
    cubic.error[2] =
        (9.0 * f + std::min(data.fifth * e / 3.0, data.fourth_deviation) / 2.0) * e * e;
    offer(cubic, middle);
  }
}

UnivariateModel finished(const UnivariateModel& best, const TaylorData& data) {
  UnivariateModel m = best;
  m.value = data.value;
  m.slope = data.slope;
  m.bend = data.bend.magnitude();
  return m;
}

// The function on pieces of an interval, which overlap so far as rounding may tear them apart.
constexpr int kPieces = 12;
struct Pieces {
  double reach;  // how far a piece extends from its middle
  std::array<double, kPieces> middle;
  std::array<DerivativeRanges, kPieces> at_middle, all;
};

Pieces cut(const std::function<DerivativeRanges(Interval)>& f, Interval range) {
  const double step = (range.hi - range.lo) / kPieces;
  Pieces p;
  p.reach = 0.5 * step * kUp + 8.0 * kEpsilon * range.magnitude();
  for (std::size_t i = 0; i < kPieces; ++i) {
    const double t = range.lo + (static_cast<double>(i) + 0.5) * step;
    p.middle[i] = t;
    p.at_middle[i] = f(Interval::point(t));
    p.all[i] = f(topology::outward(t - p.reach, t + p.reach));
  }
  return p;
}

// Bounds on the distance of f and its first two derivatives from a cubic with exact coefficients
// b[i].lo: on each piece from the distances in its middle and the next derivatives' ranges. The
// value's is made symmetric by moving the constant.
void measure(const Pieces& f, double origin, Candidate& p) {
  const Interval two = Interval::point(2.0), three = Interval::point(3.0);
  const Interval third = Interval::point(6.0) * p.b[3];
  const double h = f.reach * kUp;
  Interval value{kInfinity, -kInfinity};
  double slope = 0.0, bend = 0.0;
  for (std::size_t i = 0; i < kPieces; ++i) {
    const Interval e = Interval::point(f.middle[i]) - Interval::point(origin);
    const Interval p0 = p.b[0] + e * (p.b[1] + e * (p.b[2] + e * p.b[3]));
    const Interval p1 = p.b[1] + e * (two * p.b[2] + e * (three * p.b[3]));
    const Interval p2 = two * p.b[2] + e * third;
    const Interval e0 = f.at_middle[i][0] - p0;
    const double e1 = (f.at_middle[i][1] - p1).magnitude();
    const double e2 = (f.at_middle[i][2] - p2).magnitude();
    const double e3 = (f.all[i][3] - third).magnitude();
    const double bends = e2 + e3 * h, reach = (e1 * h + 0.5 * bends * h * h) * kUp;
    value = {std::min(value.lo, e0.lo - reach), std::max(value.hi, e0.hi + reach)};
    slope = std::max(slope, e1 + e2 * h + 0.5 * e3 * h * h);
    bend = std::max(bend, bends);
  }
  const double shift = value.middle();
  if (std::isfinite(shift)) p.b[0] = Interval::point(p.b[0].lo + shift);
  // The constant's rounding on top, and that of the range's ends.
  p.error[0] =
      (0.5 * value.width() + 4.0 * kEpsilon * (std::abs(shift) + p.b[0].magnitude())) * kUp;
  p.error[1] = slope * kUp;
  p.error[2] = bend * kUp;
}

// Nearly the best cubics for the slope and for the value: they interpolate these at Chebyshev's
// nodes. For intervals that are wide beside the length over which the function changes.
void offer_fits(const std::function<DerivativeRanges(Interval)>& f, Interval range, Best& best) {
  const double origin = range.middle(), e = 0.5 * (range.hi - range.lo);
  const Pieces pieces = cut(f, range);
  const auto at = [&](double node, int order) {
    return f(Interval::point(origin + node * e))[static_cast<std::size_t>(order)].middle();
  };
  const auto offer = [&](double b0, double b1, double b2, double b3) {
    Candidate p;
    const double b[4] = {b0, b1, b2, b3};
    for (int i = 0; i < 4; ++i) {
      if (!std::isfinite(b[i])) return;
      p.b[i] = Interval::point(b[i]);
    }
    measure(pieces, origin, p);
    best.offer(p, origin);
  };
  const double f0 = at(0.0, 0);
  {
    constexpr double kNode = 0.8660254037844386;  // cos(pi / 6)
    const double low = at(-kNode, 1), middle = at(0.0, 1), high = at(kNode, 1);
    const double linear = (high - low) / (2.0 * kNode * e);
    const double square = (0.5 * (high + low) - middle) / (kNode * kNode * e * e);
    offer(f0, middle, 0.5 * linear, square / 3.0);
  }
  {
    constexpr double kFar = 0.9238795325112867,
                     kNear = 0.3826834323650898;  // cos(pi/8), cos(3pi/8)
    const double a = at(-kFar, 0), b = at(-kNear, 0), c = at(kNear, 0), d = at(kFar, 0);
    const double even_far = 0.5 * (a + d), even_near = 0.5 * (b + c);
    const double odd_far = 0.5 * (d - a) / kFar, odd_near = 0.5 * (c - b) / kNear;
    const double span = kFar * kFar - kNear * kNear;
    const double square = (even_far - even_near) / span, cube = (odd_far - odd_near) / span;
    offer(even_near - square * kNear * kNear, (odd_near - cube * kNear * kNear) / e,
          square / (e * e), cube / (e * e * e));
  }
}

}  // namespace

UnivariateModel univariate_model(double centre, Interval range, const TaylorData& data) {
  Best best(centre, range);
  offer_plain_and_taylor(data, centre, range, best);
  return finished(best.model(), data);
}

UnivariateModel univariate_model(double centre, Interval range,
                                 const std::function<DerivativeRanges(Interval)>& f) {
  const DerivativeRanges all = f(range);
  TaylorData data;
  data.value = all[0];
  data.slope = all[1];
  data.bend = all[2];
  const double width = range.width();
  if (std::isfinite(width)) {
    const DerivativeRanges middle = f(constant(range.middle()));
    std::copy(middle.begin(), middle.begin() + 5, data.at_middle);
    data.fourth_deviation = (all[4] - middle[4]).magnitude();
    data.fifth = all[5].magnitude();
  }
  Best best(centre, range);
  offer_plain_and_taylor(data, centre, range, best);
  // Where Taylor's polynomial leaves little of the slope's variation, or the slope varies little,
  // there is not much to gain.
  const double left = best.model().error[1];
  const double tiny = 1e-12 * (std::abs(range.lo) + std::abs(range.hi));
  if (std::isfinite(width) && width > tiny && left > 0.05 * data.slope.width() &&
      left > 0.02 * data.slope.magnitude())
    offer_fits(f, range, best);
  return finished(best.model(), data);
}

}  // namespace morsel::geom

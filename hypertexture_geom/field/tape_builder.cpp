// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/tape_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace morsel::geom {
namespace {

using topology::Box;
using topology::Interval;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Covers the roundings of the bounds' own computation.
constexpr double kUp = 1.0 + 1e-12;

Interval point(double x) { return Interval::point(x); }

// Numbers up to this size have squares and cubes.
constexpr double kLargestSingle = 1e12, kLargestDouble = 1e90;

}  // namespace

TapeValue Term::emit(TapeBuilder& builder) const { return builder.opaque(*this); }

TapeBuilder::TapeBuilder(const Box& box, double unit_roundoff)
    : unit_(unit_roundoff), scope_(scope_on(box)) {}

TapeBuilder::Scope TapeBuilder::scope_on(const Box& box) {
  Scope s;
  s.box = box;
  s.centre = topology::centre(box);
  for (int i = 0; i < 3; ++i)
    s.reach[i] = std::max(box.max[i] - s.centre[i], s.centre[i] - box.min[i]) * kUp;
  return s;
}

TapeValue TapeBuilder::field(const topology::ScalarField& f) {
  if (const auto* term = dynamic_cast<const Term*>(&f)) return term->emit(*this);
  return opaque(f);
}

TapeBuilder::Step TapeBuilder::step(TapeOp op) const {
  Step s;
  s.op = op;
  s.at_input = scope_.is_input;
  for (int a = 0; a < 3; ++a) s.point[a] = scope_.y[a].id;
  s.constants = constants_.size();
  s.words = words_.size();
  return s;
}

TapeValue TapeBuilder::append(const Step& step) {
  TapeValue v;
  v.builder = this;
  v.id = static_cast<std::uint32_t>(steps_.size());
  steps_.push_back(step);
  return v;
}

// Underflow costs at most a few of the smallest normal numbers; too large numbers void all bounds.
void TapeBuilder::check(TapeValue& v) const {
  const double underflow = single_precision() ? 1e-36 : 1e-300;
  const double largest = single_precision() ? kLargestSingle : kLargestDouble;
  const auto finish = [&](double& error, double magnitude) {
    error = error * kUp + underflow;
    if (!(magnitude < largest && error < largest)) error = kInfinity;
  };
  finish(v.error, v.range.magnitude());
  for (int i = 0; i < 3; ++i) finish(v.slope_error[i], v.slope[i].magnitude());
}

TapeValue TapeBuilder::constant(double c) {
  Step s = step(TapeOp::kConstant);
  s.at_input = true;
  constants_.push_back(c);
  TapeValue v = append(s);
  v.range = point(c);
  v.error = unit_ * std::abs(c);
  check(v);
  return v;
}

TapeValue TapeBuilder::add(const TapeValue& a, const TapeValue& b) {
  Step s = step(TapeOp::kAdd);
  s.a = a.id;
  s.b = b.id;
  s.operands = 2;
  TapeValue v = append(s);
  v.range = a.range + b.range;
  v.error = a.error + b.error;
  v.error += unit_ * (v.range.magnitude() + v.error);
  for (int i = 0; i < 3; ++i) {
    v.slope[i] = a.slope[i] + b.slope[i];
    v.slope_error[i] = a.slope_error[i] + b.slope_error[i];
    v.slope_error[i] += unit_ * (v.slope[i].magnitude() + v.slope_error[i]);
  }
  check(v);
  return v;
}

// phi(a), phi' within `slope` and |phi''| <= bend between what is computed for a and what is exact;
// phi and phi' of a number are computed to within the two roundings.
TapeValue TapeBuilder::composed(const Step& how, const TapeValue& a, Interval range, Interval slope,
                                double bend, double rounding, double slope_rounding) {
  Step s = how;
  s.a = a.id;
  s.operands = 1;
  TapeValue v = append(s);
  v.range = range;
  v.error = slope.magnitude() * a.error + rounding;
  for (int i = 0; i < 3; ++i) {
    v.slope[i] = slope * a.slope[i];
    const double steep = a.slope[i].magnitude(), computed = steep + a.slope_error[i];
    v.slope_error[i] = slope.magnitude() * a.slope_error[i] +
                       (bend * a.error + slope_rounding) * computed +
                       unit_ * (slope.magnitude() + slope_rounding) * computed;
  }
  check(v);
  return v;
}

TapeValue TapeBuilder::multiply_add(const TapeValue& a, double factor, double summand) {
  const Step s = step(TapeOp::kMultiplyAdd);
  constants_.push_back(factor);
  constants_.push_back(summand);
  const Interval range = point(factor) * a.range + point(summand);
  const double size = std::abs(factor) * (a.range.magnitude() + a.error);
  return composed(s, a, range, point(factor), 0.0, 3.0 * unit_ * (size + std::abs(summand)),
                  unit_ * std::abs(factor));
}

TapeValue TapeBuilder::multiply(const TapeValue& a, const TapeValue& b) {
  Step s = step(TapeOp::kMultiply);
  s.a = a.id;
  s.b = b.id;
  s.operands = 2;
  TapeValue v = append(s);
  v.range = a.id == b.id ? topology::square(a.range) : a.range * b.range;
  const double ma = a.range.magnitude() + a.error, mb = b.range.magnitude() + b.error;
  v.error = a.error * mb + b.error * ma + unit_ * ma * mb;
  for (int i = 0; i < 3; ++i) {
    v.slope[i] = a.slope[i] * b.range + b.slope[i] * a.range;
    const double sa = a.slope[i].magnitude() + a.slope_error[i],
                 sb = b.slope[i].magnitude() + b.slope_error[i];
    v.slope_error[i] = a.slope_error[i] * mb + sa * b.error + b.slope_error[i] * ma + sb * a.error +
                       3.0 * unit_ * (sa * mb + sb * ma);
  }
  check(v);
  return v;
}

TapeValue TapeBuilder::root(const TapeValue& a, double least) {
  const Step s = step(TapeOp::kRoot);
  // The constant is below `least` after rounding; the exact argument is not.
  const double floor = least * (1.0 - 4.0 * unit_);
  constants_.push_back(floor);
  const double lo = std::max(a.range.lo - a.error, floor * (1.0 - 4.0 * unit_));
  const double hi = std::max(a.range.hi, lo) + a.error, low = std::sqrt(lo);
  const Interval range = topology::sqrt({std::max(a.range.lo, lo), hi});
  const Interval slope{0.5 / std::sqrt(hi) / kUp, 0.5 / low * kUp};
  return composed(s, a, range, slope, 0.25 / (lo * low) * kUp, 2.0 * unit_ * std::sqrt(hi),
                  4.0 * unit_ * slope.hi);
}

TapeValue TapeBuilder::smooth_abs(const TapeValue& a, double k) {
  const Step s = step(TapeOp::kSmoothAbs);
  constants_.push_back(k);
  const Interval t = a.range;
  const auto exact = [k](double x) { return x * (x / (std::sqrt(x * x + k * k) + k)); };
  const auto slope_at = [k](double x) { return x / std::sqrt(x * x + k * k); };
  const Interval range{exact(t.mignitude()) / kUp, exact(t.magnitude()) * kUp};
  const Interval slope{std::max(-1.0, slope_at(t.lo - a.error) - 1e-12),
                       std::min(1.0, slope_at(t.hi + a.error) + 1e-12)};
  const double least = std::max(0.0, t.mignitude() - a.error), r = std::hypot(least, k);
  // k itself is rounded: the value changes by less than k's change.
  return composed(s, a, range, slope, k / r * (k / r) / r * kUp,
                  8.0 * unit_ * (range.hi + a.error) + unit_ * std::min(k, range.hi + a.error),
                  8.0 * unit_ * slope.magnitude() + unit_);
}

TapeValue TapeBuilder::soft_sign(const TapeValue& a, double k) {
  const Step s = step(TapeOp::kSoftSign);
  constants_.push_back(k);
  const Interval t = a.range;
  const auto exact = [k](double x) { return x / std::sqrt(x * x + k * k); };
  const Interval range{std::max(-1.0, exact(t.lo) - 1e-12), std::min(1.0, exact(t.hi) + 1e-12)};
  const double least = std::max(0.0, t.mignitude() - a.error), r = std::hypot(least, k);
  const Interval slope{0.0, k / r * (k / r) / r * k / k * kUp};
  // d/dk of the value is below 0.39 / k.
  return composed(s, a, range, slope, 0.8588 / (k * k) * kUp, 8.0 * unit_, 12.0 * unit_ * slope.hi);
}

TapeValue TapeBuilder::smooth_step(const TapeValue& a) {
  const Step s = step(TapeOp::kSmoothStep);
  const auto exact = [](double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * t * (10.0 + t * (6.0 * t - 15.0));
  };
  const auto slope_at = [](double t) {
    t = std::clamp(t, 0.0, 1.0);
    return 30.0 * t * t * (1.0 - t) * (1.0 - t);
  };
  const Interval wide{a.range.lo - a.error, a.range.hi + a.error};
  const double steepest =
      wide.contains(0.5) ? 1.875 : std::max(slope_at(wide.lo), slope_at(wide.hi)) + 1e-12;
  const bool flat = wide.hi <= 0.0 || wide.lo >= 1.0;
  return composed(s, a, {exact(a.range.lo) - 1e-15, exact(a.range.hi) + 1e-15}, {0.0, steepest},
                  flat ? 0.0 : 5.7736, 40.0 * unit_, 40.0 * unit_);
}

TapeValue TapeBuilder::displaced(const TapeValue (&w)[3], const Box& box, double slack,
                                 const topology::ScalarField& f) {
  Scope there = scope_on(box);
  there.is_input = false;
  double worst = 0.0;
  for (int a = 0; a < 3; ++a) {
    Imath::V3d axis(0.0);
    axis[a] = 1.0;
    there.y[a] = add(linear(axis, there.centre), w[a]);
    worst = std::max(worst, there.y[a].error);
  }
  const Scope here = scope_;
  scope_ = there;
  TapeValue v = field(f);
  scope_ = here;
  if (!(worst <= slack)) {
    v.error = kInfinity;
    for (double& e : v.slope_error) e = kInfinity;
  }
  return v;
}

template <class T>
Tape<T> TapeBuilder::finish(const TapeValue& result) const {
  Tape<T> tape;
  for (const double c : constants_) tape.constants.push_back(static_cast<T>(c));
  tape.words = words_;
  tape.opaque = opaque_;
  // Each value lives until the last step that reads it; then its register is free again.
  std::vector<std::size_t> last(steps_.size(), 0);
  const auto operands_of = [&](const Step& s, const auto& use) {
    if (s.operands > 0) use(s.a);
    if (s.operands > 1) use(s.b);
    if (s.operands == 0 && !s.at_input)
      for (const std::uint32_t p : s.point) use(p);
  };
  std::vector<bool> needed(steps_.size(), false);
  needed[result.id] = true;
  for (std::size_t i = steps_.size(); i-- > 0;)
    if (needed[i]) operands_of(steps_[i], [&](std::uint32_t id) { needed[id] = true; });
  for (std::size_t i = 0; i < steps_.size(); ++i)
    if (needed[i]) operands_of(steps_[i], [&](std::uint32_t id) { last[id] = i; });
  last[result.id] = steps_.size();
  std::vector<std::uint16_t> registers(steps_.size(), 0), available;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    if (!needed[i]) continue;
    const Step& s = steps_[i];
    // A step may not overwrite what it reads before it is done with it.
    std::uint16_t out = 0;
    if (available.empty()) {
      if (tape.registers == TapeInstruction::kInput - 1)
        throw std::length_error("the field has too many parts to be compiled");
      out = tape.registers++;
    } else {
      out = available.back();
      available.pop_back();
    }
    registers[i] = out;
    TapeInstruction in;
    in.op = s.op;
    in.out = out;
    if (s.operands > 0) in.a = registers[s.a];
    if (s.operands > 1) in.b = registers[s.b];
    if (s.operands == 0 && !s.at_input)
      for (int a = 0; a < 3; ++a) in.point[a] = registers[s.point[a]];
    in.constants = static_cast<std::uint32_t>(s.constants);
    in.words = static_cast<std::uint32_t>(s.words);
    in.count = s.count;
    tape.instructions.push_back(in);
    operands_of(s, [&](std::uint32_t id) {
      if (last[id] != i) return;
      available.push_back(registers[id]);
      last[id] = 0;  // once, though it be read twice
    });
  }
  tape.result = registers[result.id];
  return tape;
}

template Tape<float> TapeBuilder::finish(const TapeValue&) const;
template Tape<double> TapeBuilder::finish(const TapeValue&) const;

}  // namespace morsel::geom

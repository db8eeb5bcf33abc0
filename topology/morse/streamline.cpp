// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/streamline.h"

#include <algorithm>
#include <array>
#include <cmath>

// In this order: the second relies on what the first includes.
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>

#include <boost/numeric/odeint/stepper/dense_output_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>

namespace morsel::topology {
namespace {

namespace odeint = boost::numeric::odeint;
using State = std::array<double, 3>;

constexpr double kReach = 1.0 / 96.0;        // of the box: where the field is restricted to
constexpr double kLongestStep = 1.0 / 96.0;  // of the box
constexpr double kFirstStep = 1e-4;          // of the box
constexpr int kSamples = 4;                  // places of a step where a basin is looked for
constexpr double kSpacing = 1.0 / 1024.0;    // of the box, at least, between points of a path
constexpr int kRestarts = 8;                 // with shorter steps, where F didn't grow

Imath::V3d vector(const State& s) { return {s[0], s[1], s[2]}; }
State state(const Imath::V3d& v) { return {v.x, v.y, v.z}; }

}  // namespace

std::string_view to_string(StreamlineEnd end) {
  constexpr std::string_view kNames[] = {"reached a basin", "left the box", "stalled",
                                         "took too many steps"};
  return kNames[static_cast<int>(end)];
}

StreamlineTracer::StreamlineTracer(const ScalarField& field, const Box& box,
                                   std::span<const CriticalPoint> points,
                                   const MaximumFinder& maxima)
    : field_(field), box_(box), points_(points), maxima_(maxima) {
  const Imath::V3d s = box.max - box.min;
  size_ = std::max({s.x, s.y, s.z});
  reach_ = kReach * size_;
}

Jet StreamlineTracer::jet(const Imath::V3d& x) {
  if (!local_ || !local_box_.intersects(x)) {
    local_box_ = Box(x - Imath::V3d(reach_), x + Imath::V3d(reach_));
    local_ = field_.restricted_to(local_box_);
  }
  return local_->jet(x);
}

Streamline StreamlineTracer::ascend(const Imath::V3d& start, const StreamlineOptions& options) {
  Streamline line;
  line.last = start;
  const auto record = [&](const Imath::V3d& x) {
    if (!options.record) return;
    if (line.path.empty() || (x - line.path.back()).length() >= kSpacing * size_)
      line.path.push_back(x);
  };
  record(start);
  const auto arrived = [&](const Imath::V3d& x) {
    const auto maximum = maxima_.basin_of(x);
    if (!maximum) return false;
    line.end = StreamlineEnd::kBasin;
    line.maximum = *maximum;
    if (options.record) line.path.push_back(points_[*maximum].position);
    return true;
  };
  if (arrived(start)) return line;

  bool stalled = false;
  const auto uphill = [&](const State& s, State& slope, double) {
    const Imath::V3d g = jet(vector(s)).gradient;
    const double length = g.length();
    stalled = stalled || !(length > 1e-14) || !std::isfinite(length);
    slope = state(stalled ? Imath::V3d(0.0) : g / length);
  };
  const double error = options.tolerance * size_;
  double longest = kLongestStep * size_;
  const auto stepper_from = [&](const Imath::V3d& x) {
    auto stepper =
        odeint::make_dense_output(error, 0.0, longest, odeint::runge_kutta_dopri5<State>());
    stepper.initialize(state(x), 0.0, std::min(kFirstStep * size_, longest));
    return stepper;
  };
  auto stepper = stepper_from(start);
  double value = jet(start).value;
  int restarts = 0;
  for (; line.steps < options.max_steps; ++line.steps) {
    std::pair<double, double> interval;
    try {
      interval = stepper.do_step(uphill);
    } catch (const odeint::odeint_error&) {  // no step is small enough
      stalled = true;
    }
    const Imath::V3d next = vector(stepper.current_state());
    // A straight path has no error, so a step may leap over a maximum: back to before it, and
    // shorter steps from there.
    if (stalled || !(jet(next).value > value)) {
      if (++restarts > kRestarts) {
        line.end = StreamlineEnd::kStalled;
        return line;
      }
      stalled = false;
      longest = std::min(longest, interval.second - interval.first) / 8.0;
      stepper = stepper_from(line.last);
      continue;
    }
    // Samples of the dense output, so that a basin isn't passed through between two steps.
    for (int i = 1; i <= kSamples; ++i) {
      State s = stepper.current_state();
      if (i < kSamples)
        stepper.calc_state(
            interval.first + (interval.second - interval.first) * i / double{kSamples}, s);
      if (!box_.intersects(vector(s))) {
        line.last = vector(s);
        line.end = StreamlineEnd::kLeftBox;
        return line;
      }
      record(vector(s));
      if (arrived(vector(s))) return line;
    }
    line.last = next;
    value = jet(next).value;
  }
  line.end = StreamlineEnd::kStepLimit;
  return line;
}

}  // namespace morsel::topology

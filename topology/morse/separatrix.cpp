// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/separatrix.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "topology/morse/basin.h"
#include "topology/morse/classify.h"
#include "topology/morse/maximum_finder.h"
#include "topology/morse/streamline.h"

namespace morsel::topology {
namespace {

// Tolerance of a step, part of the box: tried in this order.
constexpr double kTolerances[] = {1e-8, 1e-10, 1e-12};
// First step off a critical point, part of the box. The unstable manifold bends away from the
// eigenvector by the square of it, and the flow pulls back what is off across it.
constexpr double kFirstOffset = 1e-5;
constexpr double kSmallestOffset = 1e-9;
constexpr double kLargestBasin = 1.0 / 32.0;  // of the box

// A point off `origin` along +-direction from where F grows away from it; empty when rounding hides
// it.
std::optional<Imath::V3d> leave(StreamlineTracer& tracer, const CriticalPoint& origin,
                                const Imath::V3d& direction) {
  for (double part = kFirstOffset; part >= kSmallestOffset; part *= 0.1) {
    const Imath::V3d x = origin.position + direction * (part * tracer.size());
    const Jet jet = tracer.jet(x);
    if (jet.gradient.dot(direction) > 0.0 && jet.value > origin.value - 1e-15) return x;
  }
  return std::nullopt;
}

struct Arrival {
  std::uint32_t maximum = Separatrix::kNoMaximum;
  std::vector<Imath::V3d> path;
  LostStreamline lost;  // when maximum is kNoMaximum
};

Arrival follow(StreamlineTracer& tracer, const std::vector<CriticalPoint>& points,
               const MaximumFinder& maxima, std::uint32_t from, const Imath::V3d& direction,
               bool record, std::span<const double> tolerances = kTolerances) {
  Arrival arrival;
  arrival.lost = {from, points[from].position, "F doesn't grow along the eigenvector"};
  const auto start = leave(tracer, points[from], direction);
  if (!start) return arrival;
  StreamlineOptions options;
  for (const double tolerance : tolerances) {
    options.tolerance = tolerance;
    options.record = record;
    Streamline line = tracer.ascend(*start, options);
    if (line.end == StreamlineEnd::kBasin) {
      arrival.maximum = line.maximum;
      arrival.path = std::move(line.path);
      if (record) arrival.path.insert(arrival.path.begin(), points[from].position);
      return arrival;
    }
    options.max_steps *= 8;  // along a ridge that hardly rises steps are short
    arrival.lost.last = line.last;
    arrival.lost.reason = to_string(line.end);
  }
  if (const auto near = maxima.nearest(arrival.lost.last))
    arrival.lost.reason += fmt::format("; the nearest maximum is {:.3g} away",
                                       (points[*near].position - arrival.lost.last).length());
  return arrival;
}

// From a 1-saddle any direction in the plane of v2 and v3 leads into the same component, from a
// minimum any at all. In a symmetric field some lead to a saddle: the next one is tried.
Arrival ascend_anyhow(StreamlineTracer& tracer, const std::vector<CriticalPoint>& points,
                      const MaximumFinder& maxima, std::uint32_t from) {
  const EigenSystem eigen = eigen_system(tracer.jet(points[from].position).hessian);
  Arrival arrival;
  for (const double angle : {0.0, 0.7, 2.1, 3.6, 5.2}) {
    Imath::V3d direction = eigen.vectors[2] * std::cos(angle) + eigen.vectors[1] * std::sin(angle);
    if (points[from].type == CriticalType::kMinimum)
      direction = (direction + eigen.vectors[0] * std::sin(3.1 * angle)).normalized();
    arrival = follow(tracer, points, maxima, from, direction, false, std::span(kTolerances, 1));
    if (arrival.maximum != Separatrix::kNoMaximum) return arrival;
  }
  return follow(tracer, points, maxima, from, points[from].axis, false);
}

}  // namespace

void find_basins(const ScalarField& field, MorseComplex& complex) {
  const Imath::V3d size = complex.box.max - complex.box.min;
  const double largest = kLargestBasin * std::max({size.x, size.y, size.z});
  tbb::parallel_for(std::size_t{0}, complex.points.size(), [&](std::size_t i) {
    CriticalPoint& p = complex.points[i];
    if (p.type != CriticalType::kMaximum) return;
    const Imath::V3d reach(1.01 * largest + 2.0 * p.radius);
    const auto local = field.restricted_to(Box(p.position - reach, p.position + reach));
    p.basin = certified_basin(*local, p, largest);
  });
}

void trace_separatrices(const ScalarField& field, MorseComplex& complex, bool paths,
                        std::vector<std::uint32_t>& ends, const Execution& execution) {
  const std::vector<CriticalPoint>& points = complex.points;
  const MaximumFinder maxima(points);
  // The ascents of point i; a 2-saddle has two.
  std::vector<std::vector<Arrival>> arrivals(points.size());
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, points.size(), 16),
      [&](const tbb::blocked_range<std::size_t>& range) {
        execution.check_cancel();
        StreamlineTracer tracer(field, complex.box, points, maxima);
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const auto from = static_cast<std::uint32_t>(i);
          const CriticalPoint& p = points[i];
          if (p.type == CriticalType::kSaddle2) {
            arrivals[i].push_back(follow(tracer, points, maxima, from, p.axis, paths));
            arrivals[i].push_back(follow(tracer, points, maxima, from, -p.axis, paths));
          } else if (p.type == CriticalType::kSaddle1 || p.type == CriticalType::kMinimum) {
            arrivals[i].push_back(ascend_anyhow(tracer, points, maxima, from));
          }
        }
      });
  ends.assign(points.size(), Separatrix::kNoMaximum);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    for (Arrival& a : arrivals[i]) {
      if (a.maximum == Separatrix::kNoMaximum) complex.lost.push_back(a.lost);
      if (points[i].type == CriticalType::kSaddle2)
        complex.separatrices.push_back({i, a.maximum, std::move(a.path)});
      else
        ends[i] = a.maximum;
    }
  }
}

}  // namespace morsel::topology

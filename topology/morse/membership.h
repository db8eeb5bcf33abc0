// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "topology/morse/maximum_finder.h"
#include "topology/morse/streamline.h"

namespace morsel::topology {

// The paper's membership test (sections 5.3 and 5.4): which component a point inside belongs to,
// by an ascent to a maximum and the set that the maximum is in. Slow beside a look-up in the
// labelled octree; for comparison, and as an independent witness.
class StreamlineMembership {
 public:
  // `points` as the Morse engine left them (types, basins and sets filled in); both must outlive
  // this object.
  StreamlineMembership(const ScalarField& field, const Box& box,
                       std::span<const CriticalPoint> points)
      : field_(field), box_(box), points_(points), maxima_(points) {}

  // `set` of the maximum that the ascent from `x` ends in; F(x) >= 0, or a little less for a point
  // found on the surface. Empty when the ascent reaches no basin. May be called from several
  // threads at once; many calls from one thread are cheaper with a tracer of its own (see below).
  std::optional<std::uint32_t> set_of(const Imath::V3d& x) const {
    StreamlineTracer tracer = make_tracer();
    return set_of(x, tracer);
  }

  // The same; neighbouring points share what the tracer keeps of the field. One tracer a thread.
  std::optional<std::uint32_t> set_of(const Imath::V3d& x, StreamlineTracer& tracer) const {
    const Streamline line = tracer.ascend(x);
    if (line.end != StreamlineEnd::kBasin || points_[line.maximum].set == kNoSet)
      return std::nullopt;
    return points_[line.maximum].set;
  }
  StreamlineTracer make_tracer() const { return {field_, box_, points_, maxima_}; }

 private:
  const ScalarField& field_;
  Box box_;
  std::span<const CriticalPoint> points_;
  MaximumFinder maxima_;
};

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "topology/box.h"
#include "topology/morse/maximum_finder.h"
#include "topology/scalar_field.h"

namespace morsel::topology {

enum class StreamlineEnd : std::uint8_t {
  kBasin,      // in a maximum's certified basin
  kLeftBox,    // crossed the box's boundary
  kStalled,    // the gradient vanished, or F stopped to grow
  kStepLimit,  // too many steps
};
std::string_view to_string(StreamlineEnd end);

struct StreamlineOptions {
  double tolerance = 1e-8;  // of the box's size: error allowed to a step
  int max_steps = 4000;
  bool record = false;  // keep the path
};

struct Streamline {
  StreamlineEnd end = StreamlineEnd::kStalled;
  std::uint32_t maximum = 0;  // kBasin: index of the critical point
  Imath::V3d last{0.0};
  int steps = 0;
  std::vector<Imath::V3d> path;  // from the start to the maximum, when recorded
};

// Follows dx/ds = grad F / |grad F| uphill (equation 6 of Gamito & Maddock by arc length) with the
// Dormand-Prince pair and dense output, until a maximum's certified basin is reached. Not proved:
// the integration has an error tolerance. What it does guarantee is that F grows along the way.
// One object for one thread; it keeps the field restricted to where it is.
class StreamlineTracer {
 public:
  // `field`, `points` and `maxima` (of these points) must outlive the tracer.
  StreamlineTracer(const ScalarField& field, const Box& box, std::span<const CriticalPoint> points,
                   const MaximumFinder& maxima);

  Streamline ascend(const Imath::V3d& start, const StreamlineOptions& options = {});

  // F and its derivatives at a point of the box.
  Jet jet(const Imath::V3d& x);
  double size() const { return size_; }

 private:
  const ScalarField& field_;
  Box box_;
  std::span<const CriticalPoint> points_;
  const MaximumFinder& maxima_;
  double size_;   // longest side of the box
  double reach_;  // half the side of the boxes that the field is restricted to
  Box local_box_;
  std::unique_ptr<ScalarField> local_;
};

}  // namespace morsel::topology

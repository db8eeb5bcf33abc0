// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace morsel::geom {

// How roots along a ray are found; the answers agree.
enum class Solver {
  kSphere,   // sphere tracing with one Lipschitz constant and one primitive: the paper's method
  kSegment,  // by each brick's ranges of slopes
  kModel,    // by each brick's cubic; F itself polishes the root
};

// How a root is told to be of a kept component.
enum class Membership {
  kLabels,      // by the labelled octree
  kStreamline,  // by an ascent to a maximum, as in the paper; for comparison, slow
  kOff,         // every component is kept
};

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace morsel::geom {

// How roots along a ray are found; the answers agree.
enum class Solver {
  kSegment,  // by each brick's ranges of slopes (segment.h)
  kModel,    // by each brick's cubic; F itself polishes the root (model_solver.h)
};

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/field/registry.h"

namespace morsel::geom {

// Bias after Perlin & Hoffert (1989), whose b(t) = t^(ln b / ln 1/2) maps [0, 1] to itself, 1/2 to
// b and increases, but is defined there only and has an infinite or zero slope at 0. The function
// here has the same values at 0, 1/2 and 1 and is increasing, analytic and of bounded slope on all
// of R:
//   B(t) = t + c (s(t - 1/2) - s(1/2)),  s(u) = sqrt(u^2 + k^2) - k,  |c| < 1.
// H becomes from + (to - from) B((H - from) / (to - from)).
ModulationEntry bias_entry();

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/field/registry.h"

namespace morsel::geom {

// Gain after Perlin & Hoffert (1989), there made of two halves of bias: keeps 0, 1/2 and 1 and, for
// gain above 1/2, steepens the middle and flattens the ends of [0, 1]. The function here has the
// same values at 0, 1/2 and 1 and the same slope log2(1 / (1 - gain)) at 1/2, and is increasing and
// analytic on all of R:
//   G(t) = 1/2 + alpha u + beta u / sqrt(u^2 + k^2),  u = t - 1/2.
// H becomes from + (to - from) G((H - from) / (to - from)).
ModulationEntry gain_entry();

}  // namespace morsel::geom

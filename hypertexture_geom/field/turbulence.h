// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/field/registry.h"

namespace morsel::geom {

// Adds a_0 |n(f_0 x)| + a_1 |n(f_1 x)| + ..., Perlin's turbulence (1985), with the smooth absolute
// value |t| = sqrt(t^2 + k^2) - k, k = smoothing, in place of the kinked one. Never negative for
// amplitudes that are not.
ModulationEntry turbulence_entry();

}  // namespace morsel::geom

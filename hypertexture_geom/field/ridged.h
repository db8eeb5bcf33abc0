// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/field/registry.h"

namespace morsel::geom {

// Adds a_0 r(n(f_0 x)) + a_1 r(n(f_1 x)) + ... with r(t) = offset - |t| or its square: crests where
// the noise changes sign (the signal of Musgrave's ridged multifractal, in Ebert et al., "Texturing
// and Modeling"). |t| is the smooth absolute value of turbulence, so that crests are rounded.
ModulationEntry ridged_entry();

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/field/registry.h"

namespace morsel::geom {

// Domain warp: H(x + w(x)) with w a vector of three independent noises (Perlin & Hoffert's
// noise-displaced density).
ModulationEntry warp_entry();

}  // namespace morsel::geom

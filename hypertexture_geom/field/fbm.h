// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/field/registry.h"

namespace morsel::geom {

// Adds octaves of noise (equations 3 and 13 of Gamito & Maddock).
ModulationEntry fbm_entry();

}  // namespace morsel::geom

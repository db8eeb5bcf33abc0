// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/field/registry.h"

namespace morsel::geom {

// scale H + offset.
ModulationEntry scale_offset_entry();

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/embree/bricks.h"

namespace morsel::geom {

// Fills in the brick's cubic and its errors from the model of its box (and a slack of at most 1e-6
// of it), and the slices that may hold surface.
void set_model(Brick& brick, const topology::LocalModel& model, const Imath::V3d& half);

}  // namespace morsel::geom

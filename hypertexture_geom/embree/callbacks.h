// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/embree/compat.h"
#include "hypertexture_geom/embree/ray_surface.h"

namespace morsel::geom {

// What the callbacks get as the geometry's user data.
struct CallbackData {
  const RaySurface* surface;
  double padding;  // added to each brick's box on all sides
};

// Registers the callbacks of a user geometry. `data` must outlive it.
void set_callbacks(RTCGeometry geometry, const CallbackData* data, bool occlusion_filter);

}  // namespace morsel::geom

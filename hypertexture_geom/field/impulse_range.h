// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include "hypertexture_geom/field/impulse_list.h"

namespace morsel::geom {

// Bounds on a sum of impulses everywhere on a box: of the value, and of the sizes of each first and
// of every second derivative.
struct ImpulseRange {
  double lo = 0.0, hi = 0.0;
  double gradient[3] = {};
  double hessian = 0.0;

  ImpulseRange& operator+=(const ImpulseRange& other);
};

// For a box |u_i| <= half_i about `centre` that is wide for the kernels: one to eight of their
// radii. Impulses peak in different places, so the ranges of single ones over the whole box say
// little; it is divided into parts of half a radius, in each of which positive and negative
// impulses are added by themselves. All impulses have one radius.
ImpulseRange range_of(const ImpulseList& impulses, const Imath::V3d& centre,
                      const Imath::V3d& half);

}  // namespace morsel::geom

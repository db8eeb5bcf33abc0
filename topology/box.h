// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathBox.h>
#include <Imath/ImathVec.h>

namespace morsel::topology {

// A closed, axis-aligned box; `min` <= `max` on each axis, in object-space lengths.
using Box = Imath::Box3d;

inline Imath::V3d centre(const Box& b) { return (b.min + b.max) * 0.5; }
inline Imath::V3d half_size(const Box& b) { return (b.max - b.min) * 0.5; }

}  // namespace morsel::topology

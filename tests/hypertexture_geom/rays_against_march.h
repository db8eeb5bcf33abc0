// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "hypertexture_geom/embree/geometry.h"

namespace morsel::geom::test {

// Shoots `rays` random rays (from outside and inside, axis-parallel, of any length) through Embree
// at the kept surface of `rock`, and compares each with a dense march. Fails the test unless no hit
// is missed, none is false, and every distance agrees to 1e-4 of the object's size. Results go to
// stdout and to the test's properties.
void compare_with_march(const Hypertexture& rock, double kernel_radius, int rays);

}  // namespace morsel::geom::test

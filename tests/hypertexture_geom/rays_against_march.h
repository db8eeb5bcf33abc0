// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "hypertexture_geom/embree/geometry.h"

namespace morsel::geom::test {

// Shoots `rays` random rays (from outside and inside, axis-parallel, of any length) through Embree
// at the kept surface of `rock`, and compares each with a dense march. Fails the test unless no hit
// is missed, none is false, and every distance agrees to 1e-4 of the object's size. Results go to
// stdout and to the test's properties. Every tenth ray is also traced by the segment solver, every
// fiftieth by sphere tracing, and, with `streamline`, every hundredth with the paper's streamline
// filter in place of labels: the solvers must agree; labels are certified, so that where the
// streamline differs it errs, which may happen once in a thousand rays.
struct MarchOptions {
  std::size_t least_components = 6;  // so that there is something to remove
  bool solvers = false;
  bool streamline = false;
};
void compare_with_march(const Hypertexture& rock, double kernel_radius, int rays,
                        const MarchOptions& options = {});

}  // namespace morsel::geom::test

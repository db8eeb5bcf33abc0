// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "topology/certified.h"
#include "topology/scalar_field.h"

namespace morsel::geom {

// A number L with |grad F| <= L on the box, by local models: proved, and at most about a tenth more
// than the greatest gradient that was met (as far as `max_depth` subdivisions allow). Runs in the
// caller's TBB arena; the result does not depend on the number of threads. Where models get no
// tighter from one subdivision to the one after the next, it is left at that. Throws Cancelled; the
// phase of its progress is "slopes".
double lipschitz_bound(const topology::ScalarField& field, const topology::Box& box,
                       const topology::Execution& execution = {}, int max_depth = 9);

}  // namespace morsel::geom

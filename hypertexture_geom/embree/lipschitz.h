// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "topology/scalar_field.h"

namespace morsel::geom {

// A number L with |grad F| <= L on the box, by local models: proved, and at most about a tenth more
// than the greatest gradient that was met (as far as `max_depth` subdivisions allow). Runs in the
// caller's TBB arena; the result does not depend on the number of threads.
double lipschitz_bound(const topology::ScalarField& field, const topology::Box& box,
                       int max_depth = 9);

}  // namespace morsel::geom

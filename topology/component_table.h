// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "topology/certified.h"
#include "topology/forest.h"

namespace morsel::topology {

// From a complete octree: joins the cells, first within each tree, then across the faces between
// trees; numbers the components by decreasing volume, writes each leaf's component, and fills in
// the table, the bounds of the count and what is unresolved. The result does not depend on the
// number of threads. Throws Cancelled.
void label_components(const ScalarField& field, Forest& forest, const Execution& execution,
                      Topology& topology);

}  // namespace morsel::topology

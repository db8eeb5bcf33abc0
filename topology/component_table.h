// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "topology/certified.h"

namespace morsel::topology {

// From a complete octree: joins the cells, numbers the components by decreasing volume, writes each
// leaf's component, and fills in the table, the bounds of the count and what is unresolved.
void label_components(const ScalarField& field, Topology& topology);

}  // namespace morsel::topology

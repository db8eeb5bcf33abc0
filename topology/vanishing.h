// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "topology/scalar_field.h"

namespace morsel::topology {

// Whether F, as far as rounding lets one tell, is zero all along an edge of the model's box, by a
// few of its points: no sign can be proved there, and none of the cells into which the box may be
// divided, of which ever more lie along the edge, will do better. Surfaces that lie in a plane of
// the octree do that, or cross two of them in one line. The answer is a matter of cost, not of
// proof: what is not divided is reported as undecided. `field` holds on the model's box.
bool vanishes_along_edge(const ScalarField& field, const LocalModel& model);

}  // namespace morsel::topology

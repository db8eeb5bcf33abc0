// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "topology/octree.h"
#include "topology/scalar_field.h"

namespace morsel::topology::meshing {

// The mesh is that of F = level > 0: a surface that touches a plane of the octree, or lies in it,
// would else never be told from one that does not. The two surfaces have the same topology where
// the gradient does not vanish between them, which is proved cell by cell.
struct Levels {
  // A negligible share of the error, and of the cells' size, times F's typical slope: where the
  // surface only just touches a plane, the higher the level the sooner that is seen.
  double highest = 0.0;
  // Well above what rounding leaves unknown of F. A thinner bridge, or gap, than the level can't be
  // proved, so the level is lowered as far as this where one is in the way.
  double lowest = 0.0;

  double below(double level) const;  // the next to try, at least `lowest`
};

// From a sample of the octree's leaves that hold surface of a component with kept[id]. Throws
// std::invalid_argument when rounding alone takes up an error as small as `error`.
Levels levels_for(const ScalarField& field, const OctreeView& octree, const std::vector<bool>& kept,
                  double error);

}  // namespace morsel::topology::meshing

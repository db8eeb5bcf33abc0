// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "topology/box.h"
#include "topology/certified.h"
#include "topology/scalar_field.h"

namespace morsel::topology {

// A box for the topology stage: the bounding box of the points with F >= 0 that grids within
// `outer` meet (refined until neighbouring points are 1/64 of the box apart), grown by 4 % of its
// size and then, face by face, until F < 0 is proved on all of the boundary or `outer` is reached.
// So no piece of the solid is cut; a piece that lies wholly beyond the box is not part of what is
// certified. Empty when no grid point is inside. Does not depend on the number of threads. Throws
// Cancelled.
Box find_solid(const ScalarField& field, const Box& outer, const Execution& execution = {});

// Where {F >= 0} may reach the boundary of the box and be cut: a point of a face where F >= 0, or
// the centre of a very small piece on which F < 0 is not proved. Empty when it is proved on all of
// the boundary. Throws Cancelled.
std::optional<Imath::V3d> place_where_cut(const ScalarField& field, const Box& box,
                                          const Execution& execution = {});

// A point of `outer` but not of `box` with F >= 0: of a grid, the one where F is largest; empty
// when the grid, the one that find_solid begins with, meets none. Small pieces can be missed.
std::optional<Imath::V3d> place_beyond(const ScalarField& field, const Box& outer, const Box& box);

}  // namespace morsel::topology

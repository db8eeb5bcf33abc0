// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "topology/certified.h"
#include "topology/scalar_field.h"

namespace morsel::topology {

// The Euler characteristic of every component of a certified topology (1 for a ball, 0 for a solid
// torus, 2 for a shell about a cavity), from its octree and F; proved, like the labels.
//
// The cascade retracts S∩P, P a cell or a face of one, onto a full box or a vertex where it is not
// empty: S∩P is contractible, of Euler characteristic 1. The octree's cells, with the rectangles,
// edges and vertices where they meet inside the box, satisfy for every point x of the box: the
// number of cells at x, less rectangles, plus edges, less vertices, is 1 (a ball about x is cut
// into a regular complex). The Euler characteristic is additive, so that
//   chi(S) = sum over cells chi(S∩P) - rectangles + edges - vertices,
// where only S on edges and vertices is still to be found: an edge is split until F is monotone or
// of one sign on each piece.
struct OctreeEuler {
  std::vector<std::int64_t> of_component;
  std::vector<Unresolved> undecided;  // edges and vertices where the sign of F is not certain
};

// `topology` must be certified. Throws Cancelled.
OctreeEuler octree_euler(const ScalarField& field, const Topology& topology,
                         const Execution& execution = {});

}  // namespace morsel::topology

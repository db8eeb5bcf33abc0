// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "topology/mesh/cell_set.h"
#include "topology/mesh/corners.h"

namespace morsel::topology::meshing {

// An edge of the octree without a corner in its interior (a minimal edge) at whose ends F has
// different signs. It is a whole edge of the smallest cells around it.
struct CutEdge {
  std::uint32_t cell;  // the first of those
  std::uint8_t axis;
  std::uint8_t low_corner;  // corner of `cell` at the edge's lower end
  bool rising;              // the upper end is in S
  // The cells around the edge: with u, v the axes after `axis` in cyclic order, those towards
  // (-u, -v), (+u, -v), (+u, +v), (-u, +v). A cell that has the edge within a face comes twice.
  std::array<std::uint32_t, 4> ring;

  unsigned high_corner() const { return low_corner | (1u << axis); }
};

// A minimal edge with different signs at its ends that a cell with kept surface shares with one
// without. In exact arithmetic there is none in a certified octree; see close_surface.
struct OpenEdge {
  std::uint32_t cell;
  std::uint8_t axis;
  std::uint8_t low_corner;
};

struct CutEdges {
  std::vector<CutEdge> edges;  // in order of their cells
  std::vector<OpenEdge> open;
};

// Throws MeshOpen when a corner in S lies on the boundary of the octree's box: in a resolved cell
// there is one as soon as S meets that boundary.
CutEdges find_cut_edges(const CellSet& cells, const Corners& corners, const Execution& execution);

// As find_cut_edges, after changing signs of corners until no edge is open: where F is 0 to within
// rounding, or where the octree itself is undecided; the cells in question are appended to
// `doubtful`.
std::vector<CutEdge> close_surface(const CellSet& cells, Corners& corners,
                                   const Execution& execution,
                                   std::vector<std::uint32_t>& doubtful);

}  // namespace morsel::topology::meshing

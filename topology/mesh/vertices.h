// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <span>
#include <vector>

#include "topology/mesh/cell_set.h"
#include "topology/mesh/cut_edges.h"

namespace morsel::topology::meshing {

// A vertex of the mesh and a bound on |F| there: proved, with the level at which the mesh is made.
struct Vertex {
  Imath::V3d position{0.0};
  double residual = 0.0;
};

// Where the surface crosses the edge: the root of F, but not nearer to the edge's ends than a small
// share of the error, so that the vertices of edges that meet in a corner are distinct.
Vertex vertex_on(const CellSet& cells, const Corners& corners, const CutEdge& edge);

// A point of the surface in the interior of the cell, near the middle of the given points on its
// boundary. Strictly inside the cell in any case; `residual` tells how near to the surface.
Vertex apex_in(const CellSet& cells, std::uint32_t cell, std::span<const Imath::V3d> boundary);

}  // namespace morsel::topology::meshing

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "topology/mesh/cell_set.h"
#include "topology/mesh/cut_edges.h"

namespace morsel::topology::meshing {

// The surface crosses the rectangle that two cells share in segments between cut edges of its
// boundary. The segments on the faces of one cell form closed polygons: where the surface enters
// and leaves the cell. A polygon is a run of `corners`, which are indices of cut edges; seen from
// outside S they run counter-clockwise.
struct Polygon {
  std::uint32_t cell;
  std::uint32_t first;  // in Polygons::corners
  std::uint32_t size;   // >= 3
};

struct Polygons {
  std::vector<Polygon> polygons;  // by cell; more than one in a cell only if it is not resolved
  std::vector<std::uint32_t> corners;
};

Polygons find_polygons(const CellSet& cells, const std::vector<CutEdge>& edges,
                       const Execution& execution);

}  // namespace morsel::topology::meshing

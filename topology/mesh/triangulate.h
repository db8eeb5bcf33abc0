// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "topology/mesh/cell_set.h"
#include "topology/mesh/polygons.h"
#include "topology/mesh/vertices.h"

namespace morsel::topology::meshing {

// How a polygon is filled with triangles.
struct Filling {
  double error = 0.0;        // bound on their distance from F = 0
  bool has_apex = false;     // a triangle on each side with its tip at `apex`; else a fan
  std::uint32_t centre = 0;  // place in the polygon of the corner that is common to a fan
  Vertex apex;
};

// The fan with the least error if that is within the permitted one and it is proved not to
// intersect itself, else triangles around an apex. `on_edge` are the vertices of the cut edges.
Filling fill(const CellSet& cells, const Polygons& polygons, const Polygon& polygon,
             const std::vector<Vertex>& on_edge);

// Appends the triangles; `apex` is the index of the polygon's apex vertex, if it has one.
void append_triangles(const Polygons& polygons, const Polygon& polygon, const Filling& filling,
                      std::uint32_t apex, std::vector<std::array<std::uint32_t, 3>>& out);

}  // namespace morsel::topology::meshing

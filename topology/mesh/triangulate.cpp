// SPDX-License-Identifier: Apache-2.0
#include "topology/mesh/triangulate.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace morsel::topology::meshing {
namespace {

using Points = std::vector<Imath::V3d>;

// Whether the fan around corner `c` is a graph over the plane across the surface's normal, so that
// its triangles don't intersect each other: all are turned the same way, and the fan's angle at the
// centre is below 180 degrees. Up to four corners no fan intersects itself: two triangles on a
// common side meet elsewhere only if they are folded onto each other, and the corners of a planar
// section of a cell are in convex position.
bool is_graph(const Points& p, std::size_t c, const Imath::V3d& outward) {
  const std::size_t n = p.size();
  if (n <= 4) return true;
  const auto spoke = [&](std::size_t k) { return p[(c + k) % n] - p[c]; };
  const auto turn = [&](const Imath::V3d& a, const Imath::V3d& b) {
    return a.cross(b).dot(outward);
  };
  // Angles below 180 degrees between the first spoke and all others, in increasing order.
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const Imath::V3d a = spoke(k), b = spoke(k + 1);
    const double enough = 1e-9 * a.length() * b.length();
    if (!(turn(a, b) > enough)) return false;
    if (!(turn(spoke(1), b) > 1e-9 * spoke(1).length() * b.length())) return false;
  }
  return true;
}

Filling fill_within(const CellBounds& bounds, const CellSet& cells, const Polygons& polygons,
                    const Polygon& polygon, const std::vector<Vertex>& on_edge) {
  Points p;
  double residual = 0.0;
  for (std::uint32_t k = 0; k < polygon.size; ++k) {
    const Vertex& v = on_edge[polygons.corners[polygon.first + k]];
    p.push_back(v.position);
    residual = std::max(residual, v.residual);
  }
  const std::size_t n = p.size();

  // Newell's normal: the sum of the polygon's oriented areas.
  Imath::V3d outward(0.0);
  for (std::size_t k = 0; k < n; ++k) outward += p[k].cross(p[(k + 1) % n]);
  outward.normalize();

  Filling best;
  best.error = std::numeric_limits<double>::infinity();
  const std::size_t centres = n == 3 ? 1 : n == 4 ? 2 : n;  // the distinct fans
  for (std::size_t c = 0; c < centres; ++c) {
    double error = 0.0;
    for (std::size_t k = 1; k + 1 < n && error < best.error; ++k)
      error = std::max(error,
                       bounds.triangle_error({p[c], p[(c + k) % n], p[(c + k + 1) % n]}, residual));
    if (error < best.error && is_graph(p, c, outward)) {
      best.error = error;
      best.centre = static_cast<std::uint32_t>(c);
    }
  }
  if (best.error <= cells.error()) return best;

  Filling around;
  around.has_apex = true;
  around.apex = apex_in(cells, polygon.cell, p);
  residual = std::max(residual, around.apex.residual);
  for (std::size_t k = 0; k < n; ++k)
    around.error =
        std::max(around.error,
                 bounds.triangle_error({around.apex.position, p[k], p[(k + 1) % n]}, residual));
  return around;
}

}  // namespace

Filling fill(const CellSet& cells, const Polygons& polygons, const Polygon& polygon,
             const std::vector<Vertex>& on_edge) {
  Filling filling = fill_within(cells.bounds(polygon.cell), cells, polygons, polygon, on_edge);
  if (std::isfinite(filling.error) || !(cells.bounds(polygon.cell).slope > 0.0)) return filling;
  // Next to a saddle the cells may be smaller than what lies between the level and F = 0.
  const CellBounds& own = cells.bounds(polygon.cell);
  const double reach =
      std::min(cells.error(), std::max(own.reach, 8.0 * cells.level() / own.slope));
  if (!(reach > own.reach)) return filling;
  const CellBounds wider = cells.bounds_with_reach(polygon.cell, reach);
  return fill_within(wider, cells, polygons, polygon, on_edge);
}

void append_triangles(const Polygons& polygons, const Polygon& polygon, const Filling& filling,
                      std::uint32_t apex, std::vector<std::array<std::uint32_t, 3>>& out) {
  const std::uint32_t n = polygon.size;
  const auto corner = [&](std::uint32_t k) { return polygons.corners[polygon.first + k % n]; };
  if (filling.has_apex) {
    for (std::uint32_t k = 0; k < n; ++k) out.push_back({apex, corner(k), corner(k + 1)});
    return;
  }
  const std::uint32_t c = filling.centre;
  for (std::uint32_t k = 1; k + 1 < n; ++k)
    out.push_back({corner(c), corner(c + k), corner(c + k + 1)});
}

}  // namespace morsel::topology::meshing

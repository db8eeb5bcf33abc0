// SPDX-License-Identifier: Apache-2.0
#include "topology/mesh/cut_edges.h"

#include <algorithm>
#include <cmath>

#include "topology/mesh/parallel.h"

namespace morsel::topology::meshing {
namespace {

// The four cells around an edge, and whether the edge is minimal and the cell the one to have it.
struct Ring {
  std::array<std::uint32_t, 4> cells{};
  bool owned = true;
  bool open = false;
};

Ring ring_around(const CellSet& cells, std::uint32_t cell, unsigned axis, unsigned low_corner) {
  const MeshCell& own = cells[cell];
  const unsigned u = (axis + 1) % 3, v = (axis + 2) % 3;
  const GridPoint low = own.corner(low_corner);
  // The grid interval at the middle of the edge: a smaller cell at the edge makes the octree divide
  // there, even if no cell is left at the middle itself.
  std::array<std::uint32_t, 3> place = low.at;
  place[axis] += own.size() / 2;
  Ring ring;
  for (unsigned q = 0; q < 4; ++q) {
    std::array<std::uint32_t, 3> p = place;
    if (q == 0 || q == 3) --p[u];  // wraps round to a huge number on the box's boundary
    if (q == 0 || q == 1) --p[v];
    if (p[u] >= kGridSize || p[v] >= kGridSize) throw MeshOpen(cells.grid().point(low));
    const CellIndex::Found found = cells.index().at(p);
    if (found.depth > own.depth) {
      ring.owned = false;
      return ring;
    }
    ring.cells[q] = found.cell;
    if (found.cell == kNoCell)
      ring.open = true;
    else if (found.depth == own.depth && found.cell < cell)
      ring.owned = false;
  }
  return ring;
}

template <class Visit>
void for_each_cut_edge_of(const Corners& corners, std::uint32_t cell, Visit&& visit) {
  const unsigned mask = corners.mask(cell);
  if (mask == 0 || mask == 255) return;
  for (unsigned axis = 0; axis < 3; ++axis) {
    for (unsigned i = 0; i < 8; ++i) {
      if ((i >> axis) & 1u) continue;
      const bool low = (mask >> i) & 1u, high = (mask >> (i | (1u << axis))) & 1u;
      if (low != high) visit(axis, i, high);
    }
  }
}

void refuse_open(const CellSet& cells, const Corners& corners, std::uint32_t cell) {
  if (face_on_box(cells[cell]).side == 0) return;
  for (unsigned i = 0; i < 8; ++i) {
    const GridPoint corner = cells[cell].corner(i);
    for (const std::uint32_t at : corner.at)
      if ((at == 0 || at == kGridSize) && corners.inside(cell, i))
        throw MeshOpen(cells.grid().point(corner));
  }
}

}  // namespace

CutEdges find_cut_edges(const CellSet& cells, const Corners& corners, const Execution& execution) {
  struct Found {
    CutEdge edge;
    bool open;
  };
  const std::vector<Found> found = collect_pieces<Found>(
      cells.size(), execution, nullptr,
      [&](std::size_t first, std::size_t last, std::vector<Found>& out) {
        for (auto c = static_cast<std::uint32_t>(first); c < last; ++c) {
          refuse_open(cells, corners, c);
          for_each_cut_edge_of(corners, c, [&](unsigned axis, unsigned corner, bool rising) {
            const Ring ring = ring_around(cells, c, axis, corner);
            if (!ring.owned) return;
            out.push_back({{c, static_cast<std::uint8_t>(axis), static_cast<std::uint8_t>(corner),
                            rising, ring.cells},
                           ring.open});
          });
        }
      });
  CutEdges result;
  result.edges.reserve(found.size());
  for (const Found& f : found) {
    if (f.open)
      result.open.push_back({f.edge.cell, f.edge.axis, f.edge.low_corner});
    else
      result.edges.push_back(f.edge);
  }
  return result;
}

std::vector<CutEdge> close_surface(const CellSet& cells, Corners& corners,
                                   const Execution& execution,
                                   std::vector<std::uint32_t>& doubtful) {
  // The sign of the end where F is nearer to 0 is changed; should that not come to an end, the
  // solid is cut back, which must.
  constexpr int kPatience = 8;
  for (int round = 0;; ++round) {
    CutEdges found = find_cut_edges(cells, corners, execution);
    if (found.open.empty()) return std::move(found.edges);
    for (const OpenEdge& e : found.open) {
      const unsigned high_corner = e.low_corner | (1u << e.axis);
      const bool low = corners.inside(e.cell, e.low_corner);
      if (low == corners.inside(e.cell, high_corner)) continue;  // by now
      const bool low_is_nearer = std::abs(corners.value(e.cell, e.low_corner)) <=
                                 std::abs(corners.value(e.cell, high_corner));
      const unsigned flipped =
          (round < kPatience ? low_is_nearer : low) ? e.low_corner : high_corner;
      corners.flip(e.cell, flipped);
      const CellBounds& bounds = cells.bounds(e.cell);
      const double rounding = 1e-12 * shortest_side(cells.grid().box(cells[e.cell]));
      if (!(std::abs(corners.value(e.cell, flipped)) <= rounding * bounds.slope))
        doubtful.push_back(e.cell);
    }
  }
}

}  // namespace morsel::topology::meshing

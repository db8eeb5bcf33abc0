// SPDX-License-Identifier: Apache-2.0
#include "topology/mesh/polygons.h"

#include <tbb/parallel_sort.h>

#include <stdexcept>
#include <tuple>
#include <utility>

#include "topology/mesh/parallel.h"

namespace morsel::topology::meshing {
namespace {

// A cut edge on the boundary of the rectangle that two cells share. The boundary is walked
// counter-clockwise as seen from the upper cell.
struct Crossing {
  std::uint32_t lower, upper;  // cells, along the rectangle's normal
  std::uint32_t side;          // of the rectangle, in the order of the walk
  std::uint32_t along;         // place on that side, increasing in the direction of the walk
  std::uint32_t edge;
  bool enters;  // the walk enters S here

  auto order() const { return std::tie(lower, upper, side, along); }
};

// The crossings of one edge with the rectangles around it.
void add_crossings(const CellSet& cells, const std::vector<CutEdge>& edges, std::uint32_t index,
                   std::vector<Crossing>& out) {
  const CutEdge& e = edges[index];
  const unsigned u = (e.axis + 1u) % 3, v = (e.axis + 2u) % 3;
  // Pair q: ring[q] and ring[q + 1]. The rectangle's normal; the axis across the edge within the
  // rectangle, and whether the edge is at its upper end there; whether ring[q] is the lower cell.
  struct Side {
    unsigned normal, across;
    bool at_upper, in_order;
  };
  const Side sides[4] = {
      {u, v, true, true}, {v, u, false, true}, {u, v, false, false}, {v, u, true, false}};
  for (unsigned q = 0; q < 4; ++q) {
    const std::uint32_t a = e.ring[q], b = e.ring[(q + 1) % 4];
    if (a == b) continue;
    const Side& s = sides[q];
    Crossing c;
    c.lower = s.in_order ? a : b;
    c.upper = s.in_order ? b : a;
    c.edge = index;
    // With p, q, normal right-handed the walk goes along +p at the lower end of q, then +q, -p, -q.
    const bool across_is_q = s.across == (s.normal + 2) % 3;
    const bool forward = across_is_q != s.at_upper;
    c.side = across_is_q ? (s.at_upper ? 2u : 0u) : (s.at_upper ? 1u : 3u);
    const std::uint32_t place = cells[e.cell].corner(e.low_corner).at[e.axis];
    c.along = forward ? place : kGridSize - place;
    c.enters = e.rising == forward;
    out.push_back(c);
  }
}

// A directed side of a polygon in `cell`.
struct Step {
  std::uint32_t cell, from, to;
};

// Joins the crossings of one rectangle to segments: each place where the walk enters S with the
// next one where it leaves.
void add_steps(const Crossing* first, const Crossing* last, std::vector<Step>& out) {
  const auto count = static_cast<std::size_t>(last - first);
  for (std::size_t i = 0; i < count; ++i) {
    const Crossing &c = first[i], &next = first[(i + 1) % count];
    if (!c.enters) continue;
    if (next.enters) throw std::logic_error("mesh: the signs around a face don't alternate");
    // Seen from the lower cell's outside S lies to the left of leave -> enter, so the surface's
    // outside lies to the left of enter -> leave.
    out.push_back({c.lower, c.edge, next.edge});
    out.push_back({c.upper, next.edge, c.edge});
  }
}

// The closed runs of the steps of one cell.
void add_polygons(std::vector<Step>& steps, Polygons& out) {
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i].cell == kNoCell) continue;  // used up
    const std::uint32_t cell = steps[i].cell, start = steps[i].from;
    const auto first = static_cast<std::uint32_t>(out.corners.size());
    for (std::size_t at = i;;) {
      out.corners.push_back(steps[at].from);
      const std::uint32_t to = steps[at].to;
      steps[at].cell = kNoCell;
      if (to == start) break;
      for (at = 0; at < steps.size(); ++at)
        if (steps[at].cell != kNoCell && steps[at].from == to) break;
      if (at == steps.size()) throw std::logic_error("mesh: a polygon doesn't close");
    }
    out.polygons.push_back({cell, first, static_cast<std::uint32_t>(out.corners.size()) - first});
  }
}

}  // namespace

Polygons find_polygons(const CellSet& cells, const std::vector<CutEdge>& edges,
                       const Execution& execution) {
  std::vector<Crossing> crossings = collect_pieces<Crossing>(
      edges.size(), execution, nullptr,
      [&](std::size_t first, std::size_t last, std::vector<Crossing>& out) {
        for (auto e = static_cast<std::uint32_t>(first); e < last; ++e)
          add_crossings(cells, edges, e, out);
      });
  tbb::parallel_sort(crossings.begin(), crossings.end(),
                     [](const Crossing& a, const Crossing& b) { return a.order() < b.order(); });
  execution.check_cancel();

  std::vector<Step> steps;
  steps.reserve(crossings.size());
  for (std::size_t first = 0, last; first < crossings.size(); first = last) {
    last = first + 1;
    while (last < crossings.size() && crossings[last].lower == crossings[first].lower &&
           crossings[last].upper == crossings[first].upper)
      ++last;
    add_steps(&crossings[first], &crossings[first] + (last - first), steps);
  }
  crossings = {};
  tbb::parallel_sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) {
    return std::tie(a.cell, a.from, a.to) < std::tie(b.cell, b.from, b.to);
  });
  execution.check_cancel();

  Polygons polygons;
  std::vector<Step> of_cell;
  for (std::size_t first = 0, last; first < steps.size(); first = last) {
    last = first + 1;
    while (last < steps.size() && steps[last].cell == steps[first].cell) ++last;
    of_cell.assign(steps.begin() + static_cast<std::ptrdiff_t>(first),
                   steps.begin() + static_cast<std::ptrdiff_t>(last));
    add_polygons(of_cell, polygons);
  }
  return polygons;
}

}  // namespace morsel::topology::meshing

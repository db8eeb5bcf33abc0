// SPDX-License-Identifier: Apache-2.0
#include "topology/mesh/mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "topology/mesh/cell_set.h"
#include "topology/mesh/corners.h"
#include "topology/mesh/cut_edges.h"
#include "topology/mesh/level.h"
#include "topology/mesh/level_field.h"
#include "topology/mesh/parallel.h"
#include "topology/mesh/polygons.h"
#include "topology/mesh/triangulate.h"
#include "topology/mesh/vertices.h"
#include "topology/union_find.h"

namespace morsel::topology {
namespace {

using namespace meshing;

constexpr std::size_t kListed = 1000;

// The surface in one set of cells, before it is known whether it is near enough.
struct Draft {
  std::vector<Vertex> on_edge;
  std::vector<CutEdge> edges;
  Polygons polygons;
  std::vector<Filling> fillings;        // of each polygon
  std::vector<std::uint32_t> doubtful;  // cells: see close_surface
};

Draft draw(const CellSet& cells, const Execution& execution) {
  Draft d;
  Corners corners(cells, execution);
  d.edges = close_surface(cells, corners, execution, d.doubtful);
  d.on_edge.resize(d.edges.size());
  for_pieces(d.edges.size(), execution, "edges", [&](std::size_t first, std::size_t last) {
    for (std::size_t e = first; e < last; ++e) d.on_edge[e] = vertex_on(cells, corners, d.edges[e]);
  });
  d.polygons = find_polygons(cells, d.edges, execution);
  d.fillings.resize(d.polygons.polygons.size());
  for_pieces(d.fillings.size(), execution, "triangles", [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      d.fillings[i] = fill(cells, d.polygons, d.polygons.polygons[i], d.on_edge);
  });
  return d;
}

// Cells whose triangles are too far from the surface.
struct TooCoarse {
  std::vector<bool> marked;  // those that subdivision may help
  bool any = false;          // of them
  bool level = false;        // in some it is the level that is too far from F = 0
};

TooCoarse too_coarse(const CellSet& cells, const Draft& d, bool level_is_lowest) {
  TooCoarse result{std::vector<bool>(cells.size(), false)};
  for (std::size_t i = 0; i < d.fillings.size(); ++i) {
    const std::uint32_t cell = d.polygons.polygons[i].cell;
    if (d.fillings[i].error <= cells.error() || cells[cell].depth >= cells.max_depth()) continue;
    const CellBounds& bounds = cells.bounds(cell);
    if (!level_is_lowest && bounds.slope > 0.0 &&
        cells.level() > 0.25 * bounds.slope * bounds.reach)
      result.level = true;
    result.marked[cell] = true;
    result.any = true;
  }
  return result;
}

// The cells in which the topology is not proved.
std::vector<BoundedCell> unproved(const std::vector<BoundedCell>& cells) {
  std::vector<BoundedCell> result;
  for (const BoundedCell& c : cells)
    if (!c.bounds.is_proved()) result.push_back(c);
  return result;
}

// The cells of the surface at one level.
std::vector<BoundedCell> cells_at(double level, const ScalarField& field, const Grid& grid,
                                  std::vector<BoundedCell> cells, CellGoal goal,
                                  const Execution& execution) {
  goal.level = level;
  const LevelField<const ScalarField*> level_field(&field, level);
  return CellSet(level_field, grid, std::move(cells), goal).fine_cells(execution);
}

// What is not proved, cell by cell.
void report_unresolved(const ScalarField& field, const CellSet& cells, const Draft& d, Mesh& mesh) {
  std::vector<bool> marked(cells.size(), false);
  mesh.certified = true;
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    if (cells.bounds(i).is_proved()) continue;
    marked[i] = true;
    mesh.certified = false;
  }
  for (const std::uint32_t i : d.doubtful) {
    marked[i] = true;
    mesh.certified = false;
  }
  for (std::size_t i = 0; i < d.fillings.size(); ++i)
    if (d.fillings[i].error > cells.error()) marked[d.polygons.polygons[i].cell] = true;
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    if (!marked[i]) continue;
    ++mesh.unresolved_cells;
    if (mesh.unresolved.size() >= kListed) continue;
    const Box box = cells.grid().box(cells[i]);
    mesh.unresolved.push_back({box, field.value(centre(box))});
  }
}

// Where the labels are not proved a surface may run through cells of several components: it gets
// the first of them.
void one_component_a_surface(Mesh& mesh) {
  UnionFind sets(mesh.positions.size());
  for (const auto& t : mesh.triangles) {
    sets.unite(t[0], t[1]);
    sets.unite(t[1], t[2]);
  }
  std::vector<std::uint32_t> least(mesh.positions.size(), kNoComponent);
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) {
    std::uint32_t& id = least[sets.find(i)];
    id = std::min(id, mesh.components[i]);
  }
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i)
    mesh.components[i] = least[sets.find(i)];
}

Mesh finish(const ScalarField& field, const CellSet& cells, Draft& d, const Execution& execution) {
  Mesh mesh;
  report_unresolved(field, cells, d, mesh);
  mesh.cells = cells.size();
  for (std::uint32_t i = 0; i < cells.size(); ++i)
    mesh.depth = std::max(mesh.depth, int{cells[i].depth});

  std::vector<std::uint32_t> cell_of;  // of each vertex
  for (std::size_t e = 0; e < d.edges.size(); ++e) {
    mesh.positions.push_back(d.on_edge[e].position);
    cell_of.push_back(d.edges[e].cell);
  }
  for (std::size_t i = 0; i < d.fillings.size(); ++i) {
    const Filling& f = d.fillings[i];
    const Polygon& polygon = d.polygons.polygons[i];
    mesh.error_bound = std::max(mesh.error_bound, f.error);
    append_triangles(d.polygons, polygon, f, static_cast<std::uint32_t>(mesh.positions.size()),
                     mesh.triangles);
    if (!f.has_apex) continue;
    mesh.positions.push_back(f.apex.position);
    cell_of.push_back(polygon.cell);
  }
  d = {};
  mesh.normals.resize(mesh.positions.size());
  mesh.components.resize(mesh.positions.size());
  for_pieces(mesh.positions.size(), execution, "normals", [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Imath::V3d g = cells.field(cell_of[i]).jet(mesh.positions[i]).gradient;
      mesh.normals[i] = Imath::V3f(-g.normalized());
      mesh.components[i] = cells[cell_of[i]].component;
    }
  });
  if (!mesh.certified) one_component_a_surface(mesh);
  return mesh;
}

}  // namespace

MeshOpen::MeshOpen(const Imath::V3d& where)
    : std::runtime_error("the kept solid reaches the boundary of its box at (" +
                         std::to_string(where.x) + ", " + std::to_string(where.y) + ", " +
                         std::to_string(where.z) +
                         "), where its surface would end: give the geometry larger bounds"),
      place(where) {}

Mesh extract_mesh(const ScalarField& field, const OctreeView& octree, const std::vector<bool>& kept,
                  const MeshOptions& options, const Execution& execution) {
  if (!(options.error > 0.0) || !std::isfinite(options.error))
    throw std::invalid_argument("the error of a mesh must be a positive length");
  if (options.max_depth < 0 || options.max_depth > kMaxDepth)
    throw std::invalid_argument(
        fmt::format("the depth limit of a mesh must lie between 0 and {}", kMaxDepth));
  const Grid grid(octree.box);
  CellGoal goal{options.error, options.max_depth, 0.0, execution.max_bytes};
  const Levels levels = levels_for(field, octree, kept, options.error);
  const auto labelled = [&] { return labelled_cells(octree, grid, kept, goal); };
  goal.level = levels.highest;
  std::vector<BoundedCell> cells = cells_at(goal.level, field, grid, labelled(), goal, execution);
  // Whether a lower level helps is seen from the cells in question alone.
  std::vector<BoundedCell> open = unproved(cells);
  const std::size_t open_cells = open.size();
  double best = goal.level;
  for (double level = best; !open.empty() && level > levels.lowest;) {
    level = levels.below(level);
    std::vector<BoundedCell> rest = unproved(cells_at(level, field, grid, open, goal, execution));
    if (rest.size() <= open.size()) best = level;
    open = std::move(rest);
  }
  if (best < goal.level) {
    std::vector<BoundedCell> lower = cells_at(best, field, grid, labelled(), goal, execution);
    if (unproved(lower).size() <= open_cells) {
      cells = std::move(lower);
      goal.level = best;
    }
  }
  for (;;) {
    const LevelField<const ScalarField*> level_field(&field, goal.level);
    const CellSet set(level_field, grid, std::move(cells), goal);
    Draft draft = draw(set, execution);
    const TooCoarse coarse = too_coarse(set, draft, goal.level <= levels.lowest);
    if (coarse.level) {
      goal.level = levels.below(goal.level);
      cells = cells_at(goal.level, field, grid, labelled(), goal, execution);
    } else if (coarse.any) {
      cells = set.subdivided(coarse.marked, execution);
    } else {
      return finish(field, set, draft, execution);
    }
  }
}

}  // namespace morsel::topology

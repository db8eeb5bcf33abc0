// SPDX-License-Identifier: Apache-2.0
#include "topology/mesh/cell_set.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "topology/mesh/parallel.h"

namespace morsel::topology::meshing {
namespace {

// Triangles in a cell of side h that the surface cuts across have an error of at least about this
// times curvature h^2: the square through the middle of the cell, in four triangles, has 1/8 for a
// sphere (whose second fundamental form has the Frobenius norm sqrt(2) / radius).
constexpr double kLikelyError = 1.0 / 16.0;

// What a cell takes in all: itself twice, its place in the index, its corners, edges, polygon and
// triangles. Measured: 520 to 600 (topology/mesh/README.md).
constexpr std::uint64_t kBytesOfCell = 600;

}  // namespace

std::vector<BoundedCell> labelled_cells(const OctreeView& octree, const Grid& grid,
                                        const std::vector<bool>& kept, const CellGoal& goal) {
  std::vector<BoundedCell> cells;
  octree.for_each_leaf([&](const OctreeView::Leaf& leaf) {
    const OctreeNode& node = octree.nodes[leaf.node];
    const Content content = node.cell_content();
    if (content == Content::kEmpty) return;
    if (node.component >= kept.size() || !kept[node.component]) return;
    BoundedCell c;
    c.cell = grid.cell(leaf.box, leaf.depth);
    c.cell.component = node.component;
    cells.push_back(c);
    goal.check_memory(cells.size());
  });
  return cells;
}

void CellGoal::check_memory(std::uint64_t cells) const {
  if (max_bytes != 0 && cells * kBytesOfCell > max_bytes)
    throw MemoryLimit(
        fmt::format("the mesh has reached {} cells, which is as many as {:.3g} MiB allow: allow "
                    "more memory, a larger error or fewer components",
                    cells, static_cast<double>(max_bytes) * 0x1p-20));
}

void CellSet::add(const BoundedCell& cell, std::vector<BoundedCell>& out) const {
  goal_.check_memory(added_.fetch_add(1, std::memory_order_relaxed) + 1);
  out.push_back(cell);
}

std::vector<MeshCell> CellSet::plain(const std::vector<BoundedCell>& cells) {
  std::vector<MeshCell> result;
  result.reserve(cells.size());
  for (const BoundedCell& c : cells) result.push_back(c.cell);
  return result;
}

double CellSet::reach(const MeshCell& cell) const {
  return std::min(goal_.error, shortest_side(grid_.box(cell)) / 4.0);
}

std::optional<CellBounds> CellSet::examine(const ScalarField& field, const MeshCell& cell) const {
  const Box box = grid_.box(cell);
  const LocalModel model = field.model(inflated(box, reach(cell)));
  LocalModel own = model;
  own.half = half_size(box);
  // All that lies between the surface and F = 0 has to be in cells: see CellBounds::slope.
  if (avoids_zero(own, goal_.level)) return std::nullopt;
  return bounds_of(model, box, reach(cell));
}

void CellSet::refuse_open(const ScalarField& field, const MeshCell& cell) const {
  const BoxFace face = face_on_box(cell);
  if (face.side == 0) return;
  const Box box = grid_.box(cell);
  Imath::V3d place = centre(box);
  if (field.value(place) < 0.0) return;
  const int axis = static_cast<int>(face.axis);
  place[axis] = face.side < 0 ? box.min[axis] : box.max[axis];
  throw MeshOpen(place);
}

CellBounds CellSet::bounds_with_reach(std::uint32_t i, double reach) const {
  const Box box = grid_.box(cells_[i].cell);
  return bounds_of(whole_.model(inflated(box, reach)), box, reach);
}

bool CellSet::is_fine(const MeshCell& cell, const CellBounds& bounds) const {
  if (!bounds.is_proved()) return false;
  const Box box = grid_.box(cell);
  const Imath::V3d size = box.max - box.min;
  const double longest = std::max(size.x, std::max(size.y, size.z));
  return kLikelyError * bounds.curvature * longest * longest <= goal_.error;
}

void CellSet::grow_children(const ScalarField& field, const MeshCell& cell,
                            std::vector<BoundedCell>& out) const {
  const std::unique_ptr<ScalarField> local =
      field.restricted_to(inflated(grid_.box(cell), reach(cell)));
  for (unsigned i = 0; i < 8; ++i) grow(*local, cell.child(i), out);
}

void CellSet::grow(const ScalarField& field, const MeshCell& cell,
                   std::vector<BoundedCell>& out) const {
  const std::optional<CellBounds> bounds = examine(field, cell);
  if (!bounds) {
    refuse_open(field, cell);
    return;
  }
  if (cell.depth >= goal_.max_depth || is_fine(cell, *bounds))
    add({cell, *bounds}, out);
  else
    grow_children(field, cell, out);
}

std::vector<BoundedCell> CellSet::grow_node(const ScalarField& field, std::uint32_t node,
                                            const MeshCell& place,
                                            const Execution& execution) const {
  std::vector<BoundedCell> result;
  const CellIndex::Node& n = index_.nodes()[node];
  if (n.first_child == 0) {
    if (n.cell != kNoCell) grow(field, cells_[n.cell].cell, result);
    return result;
  }
  execution.check_cancel();
  const std::uint32_t some_cell = index_.first_cell_below(node);
  if (some_cell == kNoCell) return result;
  MeshCell whole = place;
  whole.component = cells_[some_cell].cell.component;
  // The surface in a resolved cell is connected, so all of it belongs to that one component.
  if (whole.depth > 0 && whole.depth <= goal_.max_depth) {
    const std::optional<CellBounds> bounds = examine(field, whole);
    if (!bounds) {
      refuse_open(field, whole);
      return result;
    }
    if (is_fine(whole, *bounds)) {
      add({whole, *bounds}, result);
      return result;
    }
  }
  const std::unique_ptr<ScalarField> local =
      field.restricted_to(inflated(grid_.box(whole), reach(whole)));
  std::array<std::vector<BoundedCell>, 8> parts;
  const auto visit = [&](std::uint32_t i) {
    parts[i] = grow_node(*local, n.first_child + i, place.child(i), execution);
  };
  constexpr int kTaskDepth = 6;
  if (place.depth < kTaskDepth) {
    tbb::parallel_for(0u, 8u, visit);
  } else {
    for (std::uint32_t i = 0; i < 8; ++i) visit(i);
  }
  for (const auto& part : parts) result.insert(result.end(), part.begin(), part.end());
  return result;
}

std::vector<BoundedCell> CellSet::fine_cells(const Execution& execution) const {
  added_ = 0;
  return grow_node(whole_, 0, MeshCell{}, execution);
}

std::vector<BoundedCell> CellSet::subdivided(const std::vector<bool>& marked,
                                             const Execution& execution) const {
  added_ = 0;
  return collect_pieces<BoundedCell>(
      size(), execution, "subdividing",
      [&](std::size_t first, std::size_t last, std::vector<BoundedCell>& out) {
        for (std::size_t i = first; i < last; ++i) {
          if (marked[i])
            grow_children(field(static_cast<std::uint32_t>(i)), cells_[i].cell, out);
          else
            add(cells_[i], out);
        }
      });
}

}  // namespace morsel::topology::meshing

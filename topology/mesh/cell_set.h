// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "topology/mesh/cell.h"
#include "topology/mesh/cell_bounds.h"
#include "topology/mesh/cell_index.h"
#include "topology/mesh/field_blocks.h"
#include "topology/mesh/mesh.h"

namespace morsel::topology::meshing {

// A cell and what is proved there.
struct BoundedCell {
  MeshCell cell;
  CellBounds bounds;
};

// What the cells of a mesh have to satisfy.
struct CellGoal {
  double error = 0.0;  // see MeshOptions
  int max_depth = 0;   // likewise
  double level = 0.0;  // the surface is where the field, plus this, is zero: see LevelField
  std::uint64_t max_bytes = 0;  // that the mesh may take while it is made; 0: no limit

  // Throws MemoryLimit when so many cells, and what becomes of them, take more than that.
  void check_memory(std::uint64_t cells) const;
};

// The leaves of the labelled octree that hold something of a kept component, in depth-first order:
// also those proved to be solid, which the surface of a level above 0 may enter. Throws
// MemoryLimit.
std::vector<BoundedCell> labelled_cells(const OctreeView& octree, const Grid& grid,
                                        const std::vector<bool>& kept, const CellGoal& goal);

// Disjoint cells that together hold all of the kept surface, with an index and restricted fields. A
// cell is *fine* if it is resolved and the error is likely to be met in it.
class CellSet {
 public:
  CellSet(const ScalarField& field, const Grid& grid, std::vector<BoundedCell> cells,
          const CellGoal& goal)
      : whole_(field),
        grid_(grid),
        goal_(goal),
        cells_(std::move(cells)),
        index_(plain(cells_)),
        fields_(field, grid, index_, cells_.size(), goal.error) {}

  std::uint32_t size() const { return static_cast<std::uint32_t>(cells_.size()); }
  const MeshCell& operator[](std::uint32_t i) const { return cells_[i].cell; }
  const CellBounds& bounds(std::uint32_t i) const { return cells_[i].bounds; }
  // The same for a larger surrounding of the cell.
  CellBounds bounds_with_reach(std::uint32_t i, double reach) const;
  const ScalarField& field(std::uint32_t i) const { return fields_.of(i); }
  const CellIndex& index() const { return index_; }
  const Grid& grid() const { return grid_; }
  double error() const { return goal_.error; }
  double level() const { return goal_.level; }
  int max_depth() const { return goal_.max_depth; }

  // The coarsest cells of the octree that hold all the surface that these cells hold and are fine;
  // where a cell of this set isn't, it is subdivided until its parts are, or are proved to hold no
  // surface, or are at the depth limit.
  std::vector<BoundedCell> fine_cells(const Execution& execution) const;

  // The cells again, but those with marked[i] subdivided once, and then until they are fine.
  std::vector<BoundedCell> subdivided(const std::vector<bool>& marked,
                                      const Execution& execution) const;

 private:
  void add(const BoundedCell& cell, std::vector<BoundedCell>& out) const;
  static std::vector<MeshCell> plain(const std::vector<BoundedCell>& cells);
  // What is known of the cell; nothing if it is proved to hold no surface.
  std::optional<CellBounds> examine(const ScalarField& field, const MeshCell& cell) const;
  // Throws MeshOpen if a cell that is proved to hold no surface is solid and touches the box's
  // boundary.
  void refuse_open(const ScalarField& field, const MeshCell& cell) const;
  bool is_fine(const MeshCell& cell, const CellBounds& bounds) const;
  double reach(const MeshCell& cell) const;
  // Appends the fine cells within a cell; `field` holds on it and its reach.
  void grow(const ScalarField& field, const MeshCell& cell, std::vector<BoundedCell>& out) const;
  void grow_children(const ScalarField& field, const MeshCell& cell,
                     std::vector<BoundedCell>& out) const;
  // The same from a node of the index, `place` being its cell, as tasks.
  std::vector<BoundedCell> grow_node(const ScalarField& field, std::uint32_t node,
                                     const MeshCell& place, const Execution& execution) const;

  const ScalarField& whole_;
  Grid grid_;
  CellGoal goal_;
  std::vector<BoundedCell> cells_;
  CellIndex index_;
  FieldBlocks fields_;
  mutable std::atomic<std::uint64_t> added_{0};  // cells of the next set
};

}  // namespace morsel::topology::meshing

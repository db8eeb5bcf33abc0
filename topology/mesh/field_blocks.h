// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "topology/mesh/cell.h"
#include "topology/mesh/cell_index.h"
#include "topology/scalar_field.h"

namespace morsel::topology::meshing {

// The field restricted to blocks of cells, so that evaluation in a cell meets few terms. A block is
// a highest octree node with at most kBlockLevels levels below it.
class FieldBlocks {
 public:
  // Fields hold on each block and `margin` around it, or a quarter of the block's size if that is
  // less.
  FieldBlocks(const ScalarField& field, const Grid& grid, const CellIndex& index,
              std::size_t cell_count, double margin);

  const ScalarField& of(std::uint32_t cell) const { return *fields_[block_[cell]]; }

 private:
  static constexpr int kBlockLevels = 3;
  struct Builder;

  std::vector<std::uint32_t> block_;  // of each cell
  std::vector<std::unique_ptr<ScalarField>> fields_;
};

}  // namespace morsel::topology::meshing

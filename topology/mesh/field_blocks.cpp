// SPDX-License-Identifier: Apache-2.0
#include "topology/mesh/field_blocks.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace morsel::topology::meshing {

struct FieldBlocks::Builder {
  FieldBlocks& blocks;
  const Grid& grid;
  const std::vector<CellIndex::Node>& nodes;
  double margin;

  struct Count {
    std::uint32_t cells = 0;
    std::uint32_t blocks = 0;
    int height = -1;  // levels down to the deepest cell; -1: none
  };
  std::vector<Count> counts;

  bool is_block(std::uint32_t node) const { return counts[node].height <= kBlockLevels; }

  void count(std::uint32_t node) {
    Count c;
    const CellIndex::Node& n = nodes[node];
    if (n.first_child == 0) {
      if (n.cell != kNoCell) c = {1, 1, 0};
    } else {
      for (std::uint32_t i = 0; i < 8; ++i) {
        count(n.first_child + i);
        const Count& child = counts[n.first_child + i];
        if (child.height < 0) continue;
        c.cells += child.cells;
        c.blocks += child.blocks;
        c.height = std::max(c.height, child.height + 1);
      }
      if (c.height >= 0 && c.height <= kBlockLevels) c.blocks = 1;
    }
    counts[node] = c;
  }

  void fill(std::uint32_t node, std::uint32_t block) {
    const CellIndex::Node& n = nodes[node];
    if (n.cell != kNoCell) blocks.block_[n.cell] = block;
    if (n.first_child != 0)
      for (std::uint32_t i = 0; i < 8; ++i) fill(n.first_child + i, block);
  }

  // `place` is the node's box as a cell; `field` holds on its parent's box and the margin.
  void descend(std::uint32_t node, const MeshCell& place, const ScalarField& field,
               std::uint32_t first_block) {
    if (counts[node].height < 0) return;
    const Box box = grid.box(place);
    std::unique_ptr<ScalarField> own =
        field.restricted_to(inflated(box, std::min(margin, shortest_side(box) / 4.0)));
    if (is_block(node)) {
      blocks.fields_[first_block] = std::move(own);
      fill(node, first_block);
      return;
    }
    const std::uint32_t first_child = nodes[node].first_child;
    std::array<std::uint32_t, 8> first;
    for (std::uint32_t i = 0; i < 8; ++i) {
      first[i] = first_block;
      first_block += counts[first_child + i].blocks;
    }
    const auto visit = [&](std::uint32_t i) {
      descend(first_child + i, place.child(i), *own, first[i]);
    };
    constexpr std::uint32_t kWorthATask = 512;
    if (counts[node].cells >= kWorthATask) {
      tbb::parallel_for(0u, 8u, visit);
    } else {
      for (std::uint32_t i = 0; i < 8; ++i) visit(i);
    }
  }
};

FieldBlocks::FieldBlocks(const ScalarField& field, const Grid& grid, const CellIndex& index,
                         std::size_t cell_count, double margin)
    : block_(cell_count, 0) {
  Builder builder{*this, grid, index.nodes(), margin, {}};
  builder.counts.resize(index.nodes().size());
  builder.count(0);
  fields_.resize(builder.counts[0].blocks);
  builder.descend(0, MeshCell{}, field, 0);
}

}  // namespace morsel::topology::meshing

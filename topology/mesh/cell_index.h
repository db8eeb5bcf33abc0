// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "topology/mesh/cell.h"

namespace morsel::topology::meshing {

// An octree over a list of cells, none of which contains another: finds the cell at a place.
class CellIndex {
 public:
  struct Node {
    std::uint32_t first_child = 0;  // of 8; 0: a leaf
    std::uint32_t cell = kNoCell;   // of a leaf; kNoCell where there is none
  };

  explicit CellIndex(const std::vector<MeshCell>& cells) : nodes_(1) {
    for (std::uint32_t i = 0; i < cells.size(); ++i) insert(cells[i], i);
  }

  const std::vector<Node>& nodes() const { return nodes_; }

  struct Found {
    std::uint32_t cell;  // kNoCell: none holds the place
    int depth;           // level of that cell, or of the empty leaf
  };
  // What holds the grid interval [x, x+1] x [y, y+1] x [z, z+1].
  Found at(const std::array<std::uint32_t, 3>& p) const {
    std::uint32_t node = 0;
    int depth = 0;
    while (nodes_[node].first_child != 0) {
      ++depth;
      node = nodes_[node].first_child + child_towards(p, depth);
    }
    return {nodes_[node].cell, depth};
  }

  // Some cell in the node or below it; kNoCell if there is none.
  std::uint32_t first_cell_below(std::uint32_t node) const {
    const Node& n = nodes_[node];
    if (n.first_child == 0) return n.cell;
    for (std::uint32_t i = 0; i < 8; ++i)
      if (const std::uint32_t cell = first_cell_below(n.first_child + i); cell != kNoCell)
        return cell;
    return kNoCell;
  }

  // Which child of a node at depth - 1 holds the grid interval at `p`.
  static std::uint32_t child_towards(const std::array<std::uint32_t, 3>& p, int depth) {
    const int shift = kMaxDepth - depth;
    return ((p[0] >> shift) & 1u) | (((p[1] >> shift) & 1u) << 1) | (((p[2] >> shift) & 1u) << 2);
  }

 private:
  void insert(const MeshCell& cell, std::uint32_t index) {
    std::uint32_t node = 0;
    for (int depth = 1; depth <= cell.depth; ++depth) {
      if (nodes_[node].first_child == 0) {
        nodes_[node].first_child = static_cast<std::uint32_t>(nodes_.size());
        nodes_.resize(nodes_.size() + 8);
      }
      node = nodes_[node].first_child + child_towards(cell.min.at, depth);
    }
    nodes_[node].cell = index;
  }

  std::vector<Node> nodes_;
};

}  // namespace morsel::topology::meshing

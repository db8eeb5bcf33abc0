// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "topology/components.h"
#include "topology/forest.h"

namespace morsel::topology {

// The pieces of S in one tree, before trees are joined: sets of certainly joined cells, and every
// unresolved cell by itself. A leaf's `component` is its piece's index meanwhile.
struct TreeLabels {
  std::vector<Component> pieces;  // no volumes or bounds for unresolved ones
  std::vector<bool> unresolved;   // piece by piece
  std::vector<std::pair<std::uint32_t, Box>> unresolved_cells;    // piece and its cell
  std::vector<std::pair<std::uint32_t, std::uint32_t>> possible;  // pieces that may be joined
  std::vector<std::array<std::uint32_t, 3>> undecided_faces;      // nodes lower, upper; axis
  std::optional<Imath::V3d> touches;  // a place on the boundary of `box` that S may reach
  std::uint64_t leaves = 0;
  std::uint64_t joins = 0;  // faces between leaves, of which neither is empty
  int depth = 0;
};

// Labels the leaves of a tree; `box` is that of the whole octree.
TreeLabels label_tree(Tree& tree, const Box& box);

// What the faces between two labelled trees say.
struct PairLabels {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> certain, possible;  // pieces lower, upper
  std::vector<std::array<std::uint32_t, 2>> undecided_faces;               // nodes lower, upper
};
PairLabels label_pair(const Tree& lower, const Tree& upper, int axis);

// Adds a piece or part of a component to a component.
void merge(Component& into, const Component& part);

}  // namespace morsel::topology

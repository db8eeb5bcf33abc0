// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topology/octree.h"

namespace morsel::topology {

// What rays need of a labelled octree, and no more. Cells grow
// - without limit while nothing kept is in them. What is removed is kConnected without a component;
// - by up to `levels` levels while no more than one component is in them, a kept one. Such a cell
// is
//   kConnected with that component, which then says that all of S in it belongs there, not that it
//   is in one piece; merged_levels() tells how many levels were below. Nothing is known of its
//   faces.
// Undecided leaves stay as they are. So a point of a kept component lies in a leaf that names it,
// or in an undecided one, as before. `kept[id]` for every component.
std::vector<OctreeNode> coarsened(std::span<const OctreeNode> nodes, const std::vector<bool>& kept,
                                  int levels);

// Of a leaf of a coarsened octree: the levels of the whole one below it, down to its deepest leaf
// with surface. 0 in any other octree.
inline int merged_levels(const OctreeNode& leaf) { return leaf.reserved; }

}  // namespace morsel::topology

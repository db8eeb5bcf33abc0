// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "topology/box.h"
#include "topology/octree.h"

namespace morsel::topology {

// One cell of the upper octree with all that is below it: a unit of work that is grown, joined and
// checkpointed by itself. Node 0 is the cell; indices count within the tree.
struct Tree {
  Box box;
  int depth = 0;
  std::uint32_t place[3] = {};  // among the 2^depth cells of its level, along each axis
  std::vector<OctreeNode> nodes;
};

// Calls visit(tree, node, depth, box) for every leaf.
template <class Visit>
void for_each_leaf_of(const Tree& tree, Visit&& visit) {
  OctreeView{tree.box, tree.nodes}.for_each_leaf(
      [&](const OctreeView::Leaf& leaf) { visit(leaf.node, tree.depth + leaf.depth, leaf.box); });
}

// An octree under construction: an upper part whose leaves are trees. Trees cover the box; they are
// numbered in depth-first order of the children.
struct Forest {
  struct Node {
    std::uint32_t first_child = 0;  // among `upper`; 0: a tree
    std::uint32_t tree = 0;
  };
  Box box;
  std::vector<Node> upper;  // node 0 is the root
  std::vector<Tree> trees;

  // One octree; the trees are used up.
  std::vector<OctreeNode> assemble();
};

// Two trees that share a face: `lower` ends along `axis` where `upper` begins.
struct TreePair {
  std::uint32_t lower, upper;
  int axis;
};
// Every pair once, in an order that depends on the upper part only.
std::vector<TreePair> neighbouring_trees(const Forest& forest);

}  // namespace morsel::topology

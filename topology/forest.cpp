// SPDX-License-Identifier: Apache-2.0
#include "topology/forest.h"

#include <limits>
#include <stdexcept>

#include "topology/adjacency.h"

namespace morsel::topology {

std::vector<TreePair> neighbouring_trees(const Forest& forest) {
  std::vector<TreePair> pairs;
  const auto is_leaf = [&](std::uint32_t n) { return forest.upper[n].first_child == 0; };
  const auto across = [&](auto&& self, std::uint32_t a, std::uint32_t b, int axis) -> void {
    if (is_leaf(a) && is_leaf(b)) {
      pairs.push_back({forest.upper[a].tree, forest.upper[b].tree, axis});
      return;
    }
    for (std::uint32_t i = 0; i < 8; ++i) {
      if ((i >> axis) & 1u) continue;
      self(self, is_leaf(a) ? a : forest.upper[a].first_child + (i | (1u << axis)),
           is_leaf(b) ? b : forest.upper[b].first_child + i, axis);
    }
  };
  const auto inside = [&](auto&& self, std::uint32_t n) -> void {
    if (is_leaf(n)) return;
    const std::uint32_t child = forest.upper[n].first_child;
    for (std::uint32_t i = 0; i < 8; ++i) self(self, child + i);
    for (int axis = 0; axis < 3; ++axis)
      for (std::uint32_t i = 0; i < 8; ++i)
        if (((i >> axis) & 1u) == 0) across(across, child + i, child + (i | (1u << axis)), axis);
  };
  inside(inside, 0);
  return pairs;
}

std::vector<OctreeNode> Forest::assemble() {
  std::size_t total = upper.size();
  for (const Tree& tree : trees) total += tree.nodes.size() - 1;
  if (total > std::numeric_limits<std::uint32_t>::max() - 8u)
    throw std::length_error("the octree has more than 2^32 nodes");
  std::vector<OctreeNode> nodes;
  nodes.reserve(total);
  nodes.resize(upper.size());
  for (std::size_t n = 0; n < upper.size(); ++n) {
    if (upper[n].first_child != 0) {
      nodes[n].first_child = upper[n].first_child;
      nodes[n].content = static_cast<std::uint8_t>(Content::kUndecided);
      continue;
    }
    std::vector<OctreeNode>& own = trees[upper[n].tree].nodes;
    // Index i of the tree, i > 0, becomes shift + i.
    const auto shift = static_cast<std::uint32_t>(nodes.size() - 1);
    nodes[n] = own[0];
    if (!own[0].is_leaf()) nodes[n].first_child += shift;
    for (std::size_t i = 1; i < own.size(); ++i) {
      nodes.push_back(own[i]);
      if (!own[i].is_leaf()) nodes.back().first_child += shift;
    }
    own = {};
  }
  return nodes;
}

}  // namespace morsel::topology

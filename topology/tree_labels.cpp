// SPDX-License-Identifier: Apache-2.0
#include "topology/tree_labels.h"

#include <algorithm>

#include "topology/adjacency.h"
#include "topology/union_find.h"

namespace morsel::topology {
namespace {

bool is_unresolved(const OctreeNode& node) { return node.cell_content() == Content::kUndecided; }

template <class T>
void sort_unique(std::vector<T>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

// A place on the boundary of `box` that S may reach in this leaf.
std::optional<Imath::V3d> place_on_boundary(const OctreeNode& node, const Box& leaf,
                                            const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const double plane = side == 0 ? box.min[axis] : box.max[axis];
      const double own = side == 0 ? leaf.min[axis] : leaf.max[axis];
      if (own != plane || node.face_content(axis, side) == Content::kEmpty) continue;
      Imath::V3d place = centre(leaf);
      place[axis] = plane;
      return place;
    }
  }
  return std::nullopt;
}

void add_cell(Component& c, const OctreeNode& node, const Box& box) {
  const Imath::V3d size = box.max - box.min;
  const double volume = size.x * size.y * size.z;
  const bool full = node.cell_content() == Content::kFull;
  // The largest full cell is the most inward place known; without one, any cell's centre.
  if (c.cells == 0 || (full && volume > c.seed_volume)) {
    c.seed = centre(box);
    if (full) c.seed_volume = volume;
  }
  ++c.cells;
  c.bounds.extendBy(box);
  c.volume_hi += volume;
  if (full) c.volume_lo += volume;
}

}  // namespace

void merge(Component& into, const Component& part) {
  if (part.cells == 0) return;
  if (into.cells == 0 || part.seed_volume > into.seed_volume) {
    into.seed = part.seed;
    into.seed_volume = part.seed_volume;
  }
  into.cells += part.cells;
  into.bounds.extendBy(part.bounds);
  into.volume_lo += part.volume_lo;
  into.volume_hi += part.volume_hi;
}

TreeLabels label_tree(Tree& tree, const Box& box) {
  TreeLabels labels;
  std::vector<OctreeNode>& nodes = tree.nodes;
  UnionFind certain(nodes.size());
  std::vector<std::array<std::uint32_t, 2>> possible;  // nodes
  const auto visit = [&](std::uint32_t a, std::uint32_t b, int axis, int depth_a, int depth_b) {
    const OctreeNode &lower = nodes[a], &upper = nodes[b];
    ++labels.joins;
    const Content shared = shared_content(lower, upper, axis, depth_a, depth_b);
    if (shared == Content::kEmpty) return;
    const bool unresolved = is_unresolved(lower) || is_unresolved(upper);
    if (!unresolved && shared != Content::kUndecided) {
      certain.unite(a, b);
      return;
    }
    possible.push_back({a, b});
    if (!unresolved) labels.undecided_faces.push_back({a, b, static_cast<std::uint32_t>(axis)});
  };
  faces_inside(nodes, 0, tree.depth, visit);

  std::vector<std::uint32_t> piece_of_root(nodes.size(), kNoComponent);
  for_each_leaf_of(tree, [&](std::uint32_t n, int depth, const Box& leaf) {
    OctreeNode& node = nodes[n];
    ++labels.leaves;
    labels.depth = std::max(labels.depth, depth);
    node.component = kNoComponent;
    if (node.cell_content() == Content::kEmpty) return;
    if (!labels.touches) labels.touches = place_on_boundary(node, leaf, box);
    std::uint32_t& piece = piece_of_root[certain.find(n)];
    if (piece == kNoComponent) {
      piece = static_cast<std::uint32_t>(labels.pieces.size());
      labels.pieces.emplace_back();
      labels.unresolved.push_back(is_unresolved(node));
      if (is_unresolved(node)) labels.unresolved_cells.emplace_back(piece, leaf);
    }
    node.component = piece;
    if (!is_unresolved(node)) add_cell(labels.pieces[piece], node, leaf);
  });
  for (const auto& [a, b] : possible)
    labels.possible.emplace_back(nodes[a].component, nodes[b].component);
  sort_unique(labels.possible);
  return labels;
}

PairLabels label_pair(const Tree& lower_tree, const Tree& upper_tree, int axis) {
  PairLabels labels;
  const auto visit = [&](std::uint32_t a, std::uint32_t b, int, int depth_a, int depth_b) {
    const OctreeNode &lower = lower_tree.nodes[a], &upper = upper_tree.nodes[b];
    const Content shared = shared_content(lower, upper, axis, depth_a, depth_b);
    if (shared == Content::kEmpty) return;
    const std::pair pieces{lower.component, upper.component};
    const bool unresolved = is_unresolved(lower) || is_unresolved(upper);
    auto& list = unresolved || shared == Content::kUndecided ? labels.possible : labels.certain;
    if (list.empty() || list.back() != pieces) list.push_back(pieces);
    if (!unresolved && shared == Content::kUndecided) labels.undecided_faces.push_back({a, b});
  };
  faces_across(lower_tree.nodes, 0, upper_tree.nodes, 0, axis, lower_tree.depth, upper_tree.depth,
               visit);
  sort_unique(labels.certain);
  sort_unique(labels.possible);
  return labels;
}

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "topology/octree.h"

namespace morsel::topology {

// Pairs of leaves that share a face (a rectangle with area), each pair once. Pairs with a leaf
// proved empty are left out: S doesn't meet their face. Calls
//   visit(lower, upper, axis, depth_lower, depth_upper)
// with node indices: `lower` ends along `axis` where `upper` begins.
//
// Between cell `a` of one array of nodes and cell `b` of another (or the same), which share a face.
template <class Visit>
void faces_across(std::span<const OctreeNode> lower_nodes, std::uint32_t a,
                  std::span<const OctreeNode> upper_nodes, std::uint32_t b, int axis, int depth_a,
                  int depth_b, Visit& visit) {
  const OctreeNode& lower = lower_nodes[a];
  const OctreeNode& upper = upper_nodes[b];
  const bool lower_leaf = lower.is_leaf(), upper_leaf = upper.is_leaf();
  if ((lower_leaf && lower.cell_content() == Content::kEmpty) ||
      (upper_leaf && upper.cell_content() == Content::kEmpty))
    return;
  if (lower_leaf && upper_leaf) {
    visit(a, b, axis, depth_a, depth_b);
    return;
  }
  for (std::uint32_t i = 0; i < 8; ++i) {
    if ((i >> axis) & 1u) continue;
    faces_across(lower_nodes, lower_leaf ? a : lower.first_child + (i | (1u << axis)), upper_nodes,
                 upper_leaf ? b : upper.first_child + i, axis, depth_a + (lower_leaf ? 0 : 1),
                 depth_b + (upper_leaf ? 0 : 1), visit);
  }
}

// Between the leaves below one cell.
template <class Visit>
void faces_inside(std::span<const OctreeNode> nodes, std::uint32_t cell, int depth, Visit& visit) {
  if (nodes[cell].is_leaf()) return;
  const std::uint32_t child = nodes[cell].first_child;
  for (std::uint32_t i = 0; i < 8; ++i) faces_inside(nodes, child + i, depth + 1, visit);
  for (int axis = 0; axis < 3; ++axis)
    for (std::uint32_t i = 0; i < 8; ++i)
      if (((i >> axis) & 1u) == 0)
        faces_across(nodes, child + i, nodes, child + (i | (1u << axis)), axis, depth + 1,
                     depth + 1, visit);
}

template <class Visit>
void for_each_face_pair(const OctreeView& octree, Visit visit) {
  faces_inside(octree.nodes, 0, 0, visit);
}

// What is known of S on the rectangle that two neighbouring leaves share: it is part of a full
// cell, or the face of the smaller one, or of either when they are equal.
inline Content shared_content(const OctreeNode& lower, const OctreeNode& upper, int axis,
                              int depth_lower, int depth_upper) {
  Content content = Content::kUndecided;
  if (lower.cell_content() == Content::kFull || upper.cell_content() == Content::kFull)
    return Content::kFull;
  if (depth_lower >= depth_upper) content = lower.face_content(axis, 1);
  if (content == Content::kUndecided && depth_upper >= depth_lower)
    content = upper.face_content(axis, 0);
  return content;
}

// An undecided face between two decided cells is resolved by subdividing the smaller cell (the
// lower one of two equal ones), which makes the face's pieces smaller. At the depth limit, or
// beside an undecided cell, or where F vanishes along an edge (vanishing.h), that can't help.
enum class Remedy { kNone, kDivideLower, kDivideUpper };
inline Remedy remedy_of(const OctreeNode& lower, const OctreeNode& upper, int axis, int depth_lower,
                        int depth_upper, int max_depth) {
  if (lower.cell_content() == Content::kUndecided || upper.cell_content() == Content::kUndecided)
    return Remedy::kNone;
  if (shared_content(lower, upper, axis, depth_lower, depth_upper) != Content::kUndecided)
    return Remedy::kNone;
  const bool first = depth_lower >= depth_upper;
  if ((first ? lower : upper).reserved == kNotToBeDivided) return Remedy::kNone;
  if ((first ? depth_lower : depth_upper) >= max_depth) return Remedy::kNone;
  return first ? Remedy::kDivideLower : Remedy::kDivideUpper;
}

}  // namespace morsel::topology

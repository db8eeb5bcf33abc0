// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "topology/octree.h"

namespace morsel::topology {

// Calls visit(lower, upper, axis, depth_lower, depth_upper) for every pair of leaves that share a
// face (a rectangle with area), each pair once; node indices. Pairs with a leaf proved empty are
// left out: S doesn't meet their face.
template <class Visit>
class FacePairs {
 public:
  FacePairs(const OctreeView& octree, Visit visit) : nodes_(octree.nodes), visit_(visit) {}

  void run() { inside(0, 0); }

 private:
  void inside(std::uint32_t cell, int depth) {
    if (nodes_[cell].is_leaf()) return;
    const std::uint32_t child = nodes_[cell].first_child;
    for (std::uint32_t i = 0; i < 8; ++i) inside(child + i, depth + 1);
    for (int axis = 0; axis < 3; ++axis)
      for (std::uint32_t i = 0; i < 8; ++i)
        if (((i >> axis) & 1) == 0)
          across(child + i, child + (i | (1u << axis)), axis, depth + 1, depth + 1);
  }

  void across(std::uint32_t lower, std::uint32_t upper, int axis, int depth_lower,
              int depth_upper) {
    const OctreeNode& a = nodes_[lower];
    const OctreeNode& b = nodes_[upper];
    if ((a.is_leaf() && a.cell_content() == Content::kEmpty) ||
        (b.is_leaf() && b.cell_content() == Content::kEmpty))
      return;
    if (a.is_leaf() && b.is_leaf()) {
      visit_(lower, upper, axis, depth_lower, depth_upper);
      return;
    }
    for (std::uint32_t i = 0; i < 8; ++i) {
      if ((i >> axis) & 1) continue;
      const std::uint32_t near_b = i, near_a = i | (1u << axis);
      across(a.is_leaf() ? lower : a.first_child + near_a,
             b.is_leaf() ? upper : b.first_child + near_b, axis,
             depth_lower + (a.is_leaf() ? 0 : 1), depth_upper + (b.is_leaf() ? 0 : 1));
    }
  }

  std::span<const OctreeNode> nodes_;
  Visit visit_;
};

template <class Visit>
void for_each_face_pair(const OctreeView& octree, Visit visit) {
  FacePairs<Visit>(octree, visit).run();
}

// What is known of S on the rectangle that two neighbouring leaves share: the face of the smaller
// one, or of either when they are equal.
inline Content shared_content(const OctreeNode& lower, const OctreeNode& upper, int axis,
                              int depth_lower, int depth_upper) {
  Content content = Content::kUndecided;
  if (depth_lower >= depth_upper) content = lower.face_content(axis, 1);
  if (content == Content::kUndecided && depth_upper >= depth_lower)
    content = upper.face_content(axis, 0);
  return content;
}

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <span>
#include <vector>

#include "topology/box.h"

namespace morsel::topology {

// What is proved of S = {F >= 0} in one closed cell or face.
enum class Content : std::uint8_t {
  kEmpty = 0,      // F < 0 everywhere
  kConnected = 1,  // S meets it, in one connected piece
  kFull = 2,       // F >= 0 everywhere
  kUndecided = 3,  // nothing
};

// `reserved` of a leaf during a build: what is undecided there stays so however it is divided.
inline constexpr std::uint8_t kNotToBeDivided = 1;

// Component of a leaf that holds no part of S, and of inner nodes.
inline constexpr std::uint32_t kNoComponent = 0xffffffffu;

// One node of a labelled octree, as it lies in memory and in a cache file (12 bytes).
struct OctreeNode {
  std::uint32_t first_child = 0;  // 0: a leaf. Otherwise the index of the first of 8 children.
  std::uint32_t component = kNoComponent;
  std::uint16_t faces = 0;    // two bits of Content a face; see face_content
  std::uint8_t content = 0;   // Content of the leaf
  std::uint8_t reserved = 0;  // 0 but during a build, and in coarsened octrees: see coarsen.h

  bool is_leaf() const { return first_child == 0; }
  Content cell_content() const { return static_cast<Content>(content); }
  // Content of the face towards `axis` (0..2) and `side` (0: lower, 1: upper).
  Content face_content(int axis, int side) const {
    return static_cast<Content>((faces >> (2 * (2 * axis + side))) & 3u);
  }
  void set_face_content(int axis, int side, Content value) {
    const int shift = 2 * (2 * axis + side);
    faces = static_cast<std::uint16_t>((faces & ~(3u << shift)) |
                                       (static_cast<unsigned>(value) << shift));
  }
};
static_assert(sizeof(OctreeNode) == 12);

// Child `i` of a cell takes the upper half along x, y, z where bit 0, 1, 2 of `i` is set.
Box child_box(const Box& box, int child);

// A view of a labelled octree; the nodes belong to a cache or to a build in progress. Node 0 is the
// root and spans `box`. Neighbouring leaves may differ in depth by any amount.
struct OctreeView {
  Box box;
  std::span<const OctreeNode> nodes;

  // A leaf with its box and depth (0: the root).
  struct Leaf {
    std::uint32_t node;
    int depth;
    Box box;
  };
  // The leaf whose closed box holds `x`; on a shared face the upper neighbour. `x` outside `box` is
  // clamped to it.
  Leaf locate(const Imath::V3d& x) const;

  // Calls visit(Leaf) for every leaf, in depth-first order of the children.
  template <class Visit>
  void for_each_leaf(Visit&& visit) const {
    struct Entry {
      std::uint32_t node;
      int depth;
      Box box;
    };
    std::vector<Entry> stack{{0, 0, box}};
    while (!stack.empty()) {
      const Entry e = stack.back();
      stack.pop_back();
      const OctreeNode& n = nodes[e.node];
      if (n.is_leaf()) {
        visit(Leaf{e.node, e.depth, e.box});
        continue;
      }
      for (int i = 7; i >= 0; --i)
        stack.push_back(
            {n.first_child + static_cast<std::uint32_t>(i), e.depth + 1, child_box(e.box, i)});
    }
  }
};

}  // namespace morsel::topology

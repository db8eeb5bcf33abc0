// SPDX-License-Identifier: Apache-2.0
#include "topology/octree.h"

namespace morsel::topology {

Box child_box(const Box& box, int child) {
  const Imath::V3d middle = centre(box);
  Box result = box;
  for (int axis = 0; axis < 3; ++axis) {
    if ((child >> axis) & 1)
      result.min[axis] = middle[axis];
    else
      result.max[axis] = middle[axis];
  }
  return result;
}

OctreeView::Leaf OctreeView::locate(const Imath::V3d& x) const {
  Leaf leaf{0, 0, box};
  while (!nodes[leaf.node].is_leaf()) {
    const Imath::V3d middle = centre(leaf.box);
    const int child =
        (x.x >= middle.x ? 1 : 0) | (x.y >= middle.y ? 2 : 0) | (x.z >= middle.z ? 4 : 0);
    leaf.box = child_box(leaf.box, child);
    leaf.node = nodes[leaf.node].first_child + static_cast<std::uint32_t>(child);
    ++leaf.depth;
  }
  return leaf;
}

}  // namespace morsel::topology

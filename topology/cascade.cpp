// SPDX-License-Identifier: Apache-2.0
#include "topology/cascade.h"

namespace morsel::topology {

Content classify(const LocalModel& model, unsigned free_axes) {
  const Interval range = model.range();
  if (range.hi < 0.0) return Content::kEmpty;
  if (range.lo >= 0.0) return Content::kFull;
  for (int axis = 0; axis < 3; ++axis) {
    const unsigned bit = 1u << axis;
    if ((free_axes & bit) == 0) continue;
    const Interval slope = model.gradient_range(axis);
    if (slope.lo < 0.0 && slope.hi > 0.0) continue;
    const int side = slope.lo >= 0.0 ? 1 : -1;
    const Content face = classify(model.on_face(axis, side), free_axes & ~bit);
    if (face == Content::kEmpty) return Content::kEmpty;
    if (face != Content::kUndecided) return Content::kConnected;
  }
  return Content::kUndecided;
}

void classify_faces(const LocalModel& model, OctreeNode& node) {
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      node.set_face_content(axis, side,
                            classify(model.on_face(axis, side == 0 ? -1 : 1), 7u & ~(1u << axis)));
}

}  // namespace morsel::topology

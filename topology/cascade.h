// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "topology/local_model.h"
#include "topology/octree.h"

namespace morsel::topology {

// The monotone retraction cascade. What S = {F >= 0} is on the model's box: if one partial
// derivative keeps its sign there, S retracts along that axis onto the face that F grows towards,
// and the question is asked again of that face, down to a vertex. See topology/README.md for the
// proof. `free_axes` has bit i set where the box extends along axis i.
Content classify(const LocalModel& model, unsigned free_axes = 7u);

// The same for the six faces of the box, packed as OctreeNode::faces has them.
void classify_faces(const LocalModel& model, OctreeNode& node);

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#include "topology/certified.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "topology/adjacency.h"
#include "topology/component_table.h"
#include "topology/tree_builder.h"

namespace morsel::topology {
namespace {

// Neither side of a face whose content is undecided proves or refutes that S crosses it: the
// smaller cell is subdivided (the lower one of two equal ones), which makes the face's pieces
// smaller.
std::vector<bool> cells_to_subdivide(const OctreeView& octree, int max_depth, bool& any) {
  std::vector<bool> marked(octree.nodes.size(), false);
  any = false;
  for_each_face_pair(octree, [&](std::uint32_t a, std::uint32_t b, int axis, int depth_a,
                                 int depth_b) {
    const OctreeNode &lower = octree.nodes[a], &upper = octree.nodes[b];
    // At the depth limit cells themselves may be undecided; their faces can't help.
    if (lower.cell_content() == Content::kUndecided || upper.cell_content() == Content::kUndecided)
      return;
    if (shared_content(lower, upper, axis, depth_a, depth_b) != Content::kUndecided) return;
    const bool first = depth_a >= depth_b;
    if ((first ? depth_a : depth_b) >= max_depth) return;
    marked[first ? a : b] = true;
    any = true;
  });
  return marked;
}

void check_box(const Box& box) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::isfinite(box.min[axis]) && std::isfinite(box.max[axis]) &&
          box.min[axis] < box.max[axis]))
      throw std::invalid_argument(
          "the box to certify must be finite and have extent along every axis");
}

}  // namespace

Box dyadic_box(const Box& box) {
  check_box(box);
  Box result;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = box.max[axis] - box.min[axis];
    const double reach = std::max(std::abs(box.min[axis]), std::abs(box.max[axis]));
    // A grid of size / 256 to 512, coarser where the box is so far from the origin that 26 halvings
    // of it would not be exact: 53 bits - 26.
    const double unit = std::ldexp(1.0, std::max(std::ilogb(size) - 8, std::ilogb(reach) - 26));
    result.min[axis] = std::floor(box.min[axis] / unit) * unit;
    result.max[axis] = std::ceil(box.max[axis] / unit) * unit;
    if (result.max[axis] == result.min[axis]) result.max[axis] += unit;
  }
  return result;
}

Topology certify(const ScalarField& field, const CertifyOptions& options,
                 const Execution& execution) {
  if (options.min_depth < 0 || options.max_depth > kMaxDepth ||
      options.min_depth > options.max_depth)
    throw std::invalid_argument("depths must satisfy 0 <= min_depth <= max_depth <= 24");
  Topology topology;
  topology.box = dyadic_box(options.box);
  TreeBuilder builder(field, topology.box, options, execution);
  topology.nodes = builder.build();
  for (bool any = true; any;) {
    const std::vector<bool> marked = cells_to_subdivide(topology.octree(), options.max_depth, any);
    if (any) builder.subdivide(topology.nodes, marked);
    if (execution.cancel != nullptr && execution.cancel->load()) throw Cancelled();
  }
  topology.models = builder.models();
  label_components(field, topology);
  return topology;
}

}  // namespace morsel::topology

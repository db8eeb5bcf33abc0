// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <vector>

#include "topology/certified.h"

namespace morsel::topology {

// Grows the octree of one certification: classifies cells, subdivides what is undecided.
class TreeBuilder {
 public:
  // `box` must be dyadic (see dyadic_box): every plane of the octree is then exact in double.
  TreeBuilder(const ScalarField& field, const Box& box, const CertifyOptions& options,
              const Execution& execution)
      : field_(field), box_(box), options_(options), execution_(execution) {}

  // The whole tree; node 0 is the root.
  std::vector<OctreeNode> build();

  // Subdivides the leaves whose `marked` flag is set, in place; new nodes are appended.
  void subdivide(std::vector<OctreeNode>& nodes, const std::vector<bool>& marked);

  std::uint64_t models() const { return models_; }

 private:
  OctreeNode classify_cell(const ScalarField& field, const Box& cell, int depth, bool& divide);
  // Fills nodes[index] and appends its descendants.
  void grow(const ScalarField& field, const Box& cell, int depth, std::vector<OctreeNode>& nodes,
            std::size_t index);
  // The children of a cell and all that is below them, each subtree in a task down to kTaskDepth.
  std::vector<OctreeNode> grow_children(const ScalarField& field, const Box& cell, int depth);
  std::vector<OctreeNode> grow_task(const ScalarField& field, const Box& cell, int depth);
  void check_cancel() const;
  void report(double volume);

  const ScalarField& field_;
  Box box_;
  const CertifyOptions& options_;
  const Execution& execution_;
  std::atomic<std::uint64_t> models_{0};
  std::mutex progress_mutex_;
  double done_ = 0.0;
};

}  // namespace morsel::topology

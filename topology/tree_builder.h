// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "topology/certified.h"
#include "topology/forest.h"

namespace morsel::topology {

// Grows the octree of one certification: classifies cells, subdivides what is undecided.
class TreeBuilder {
 public:
  // `box` must be dyadic (see dyadic_box): every plane of the octree is then exact in double.
  TreeBuilder(const ScalarField& field, const Box& box, const CertifyOptions& options,
              const Execution& execution)
      : field_(field), box_(box), options_(options), execution_(execution) {}

  // The whole octree: nothing is undecided above the depth limit, neither cells nor faces, but
  // where division can't help (see vanishing.h). Throws Cancelled, MemoryLimit and NotFinite.
  Forest build();

  std::uint64_t models() const { return models_; }

 private:
  // The upper part, and where the trees are.
  Forest plan();
  void grow(std::uint32_t index, Tree& tree);
  // Classifies the children of nodes[index], a cell to be divided, and grows what is below them.
  // `local` is the field restricted to the cell.
  void divide(const ScalarField& local, const Box& cell, int depth, std::vector<OctreeNode>& nodes,
              std::uint32_t index);
  // Divides the leaves of the tree whose indices are given.
  void divide_leaves(Tree& tree, std::span<const std::uint32_t> leaves);
  // Divides leaves until no face within the tree is undecided that could be decided.
  void resolve_inside(Tree& tree);
  // The same for faces between trees.
  void resolve_between(Forest& forest);
  bool must_divide(Content content, int depth) const;
  // Throws NotFinite where F, or all bounds of it, are not, given the error bound of the cell's
  // model.
  void check_finite(const Box& cell, int depth, double value_error) const;
  // Counts nodes that are added; throws MemoryLimit.
  void charge(std::uint64_t nodes);
  void report(double volume);

  const ScalarField& field_;
  Box box_;
  const CertifyOptions& options_;
  const Execution& execution_;
  std::atomic<std::uint64_t> models_{0};
  std::atomic<std::uint64_t> nodes_{0};
  std::mutex progress_mutex_;
  double done_ = 0.0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace morsel::topology

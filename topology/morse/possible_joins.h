// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <unordered_map>

#include "topology/certified.h"
#include "topology/union_find.h"

namespace morsel::topology {

// The certified components, and the cells that were left undecided, grouped by what may yet turn
// out to be joined: undecided cells and faces count as solid here. Components of different groups
// are apart whatever is undecided; when everything was decided, each is a group by itself.
class PossibleJoins {
 public:
  explicit PossibleJoins(const Topology& topology);

  // The group of the component or undecided cell that the leaf is of; kNoComponent when the leaf is
  // proved empty.
  std::uint32_t group_of_leaf(std::uint32_t node) const;
  // Groups are numbers below size().
  std::size_t size() const { return components_ + undecided_.size(); }
  std::uint32_t group_of_component(std::uint32_t component) const {
    return groups_.find(component);
  }

 private:
  std::uint32_t member_of(std::uint32_t node) const;

  OctreeView octree_;
  std::size_t components_;
  std::unordered_map<std::uint32_t, std::uint32_t> undecided_;  // node -> member
  mutable UnionFind groups_;  // members: components, then undecided cells
};

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/possible_joins.h"

#include "topology/adjacency.h"

namespace morsel::topology {
namespace {

std::unordered_map<std::uint32_t, std::uint32_t> undecided_cells(const Topology& topology) {
  std::unordered_map<std::uint32_t, std::uint32_t> members;
  if (topology.certified) return members;
  auto next = static_cast<std::uint32_t>(topology.components.size());
  for (std::uint32_t i = 0; i < topology.nodes.size(); ++i)
    if (topology.nodes[i].is_leaf() && topology.nodes[i].cell_content() == Content::kUndecided)
      members.emplace(i, next++);
  return members;
}

}  // namespace

PossibleJoins::PossibleJoins(const Topology& topology)
    : octree_(topology.octree()),
      components_(topology.components.size()),
      undecided_(undecided_cells(topology)),
      groups_(components_ + undecided_.size()) {
  if (topology.certified) return;
  for_each_face_pair(octree_, [&](std::uint32_t lower, std::uint32_t upper, int axis,
                                  int depth_lower, int depth_upper) {
    const Content shared =
        shared_content(octree_.nodes[lower], octree_.nodes[upper], axis, depth_lower, depth_upper);
    if (shared != Content::kEmpty) groups_.unite(member_of(lower), member_of(upper));
  });
}

std::uint32_t PossibleJoins::member_of(std::uint32_t node) const {
  const auto found = undecided_.find(node);
  return found == undecided_.end() ? octree_.nodes[node].component : found->second;
}

std::uint32_t PossibleJoins::group_of_leaf(std::uint32_t node) const {
  const std::uint32_t member = member_of(node);
  return member == kNoComponent ? kNoComponent : groups_.find(member);
}

}  // namespace morsel::topology

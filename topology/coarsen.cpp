// SPDX-License-Identifier: Apache-2.0
#include "topology/coarsen.h"

#include <algorithm>
#include <stdexcept>

namespace morsel::topology {
namespace {

// One pass in depth-first order: the children of a cell are written, what is below them follows,
// and if they turn out to make one leaf all of it is taken back.
class Coarsener {
 public:
  Coarsener(std::span<const OctreeNode> nodes, const std::vector<bool>& kept, int levels)
      : nodes_(nodes), kept_(kept), levels_(levels) {}

  std::vector<OctreeNode> run() {
    if (nodes_.empty()) return {};
    out_.push_back(node_of(0));
    below(0, 0);
    out_.shrink_to_fit();
    return std::move(out_);
  }

 private:
  static OctreeNode leaf(Content content, std::uint32_t component) {
    const Content faces = content == Content::kConnected ? Content::kUndecided : content;
    OctreeNode node;
    node.content = static_cast<std::uint8_t>(content);
    node.component = component;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) node.set_face_content(axis, side, faces);
    return node;
  }
  static OctreeNode removed() { return leaf(Content::kConnected, kNoComponent); }

  OctreeNode node_of(std::uint32_t from) const {
    const OctreeNode& node = nodes_[from];
    if (!node.is_leaf() || node.cell_content() == Content::kUndecided ||
        node.cell_content() == Content::kEmpty)
      return node;
    return node.component < kept_.size() && kept_[node.component] ? node : removed();
  }

  // out_[to] is a copy of nodes_[from].
  void below(std::uint32_t from, std::uint32_t to) {
    if (nodes_[from].is_leaf()) return;
    const std::uint32_t source = nodes_[from].first_child;
    const auto first = static_cast<std::uint32_t>(out_.size());
    for (std::uint32_t i = 0; i < 8; ++i) out_.push_back(node_of(source + i));
    out_[to].first_child = first;
    for (std::uint32_t i = 0; i < 8; ++i) below(source + i, first + i);
    if (out_.size() != first + 8) return;  // a child is divided
    OctreeNode one;
    if (!merge(first, one)) return;
    out_.resize(first);
    out_[to] = one;
  }

  // Whether the eight leaves from `first` on make one, and which.
  bool merge(std::uint32_t first, OctreeNode& one) const {
    bool any_removed = false, any_surface = false, all_full = true;
    int merged = 0;
    std::uint32_t component = kNoComponent;
    for (std::uint32_t i = first; i < first + 8; ++i) {
      const OctreeNode& child = out_[i];
      const Content content = child.cell_content();
      if (!child.is_leaf() || content == Content::kUndecided) return false;
      all_full = all_full && content == Content::kFull;
      if (content == Content::kEmpty) continue;
      if (child.component == kNoComponent) {
        any_removed = true;
        continue;
      }
      if (component != kNoComponent && child.component != component) return false;
      component = child.component;
      if (content != Content::kConnected) continue;
      any_surface = true;
      merged = std::max(merged, merged_levels(child) + 1);
    }
    if (component == kNoComponent) {
      one = any_removed ? removed() : leaf(Content::kEmpty, kNoComponent);
      return true;
    }
    if (any_removed || (!all_full && (!any_surface || merged > levels_))) return false;
    one = leaf(all_full ? Content::kFull : Content::kConnected, component);
    one.reserved = static_cast<std::uint8_t>(merged);
    return true;
  }

  std::span<const OctreeNode> nodes_;
  const std::vector<bool>& kept_;
  int levels_;
  std::vector<OctreeNode> out_;
};

}  // namespace

std::vector<OctreeNode> coarsened(std::span<const OctreeNode> nodes, const std::vector<bool>& kept,
                                  int levels) {
  if (levels < 0 || levels > 255)
    throw std::invalid_argument("an octree may be coarsened by 0 to 255 levels");
  return Coarsener(nodes, kept, levels).run();
}

}  // namespace morsel::topology

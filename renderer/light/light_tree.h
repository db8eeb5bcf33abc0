// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/light/light.h"

namespace morsel::render {

// A binary tree over lights, from which one is chosen in as many steps as it is deep: at each node
// in proportion to what its two halves can bring to a point at most. Built by the surface area
// orientation heuristic of Conty Estevez & Kulla, "Importance Sampling of Many Lights with Adaptive
// Tree Splitting", 2018.
class LightTree {
 public:
  // Lights without power are left out: they are never chosen.
  explicit LightTree(const std::vector<LightBounds>& lights);

  bool empty() const { return nodes_.empty(); }
  // Of the whole, at `p`.
  float importance(const V3f& p) const { return empty() ? 0.0f : nodes_[0].bounds.importance(p); }

  // `leaf_importance(light)` replaces the bounds' estimate at single lights. Probability 0: none.
  struct Choice {
    std::uint32_t light = 0;
    float probability = 0.0f;
  };
  template <class LeafImportance>
  Choice sample(const V3f& p, float u, LeafImportance&& leaf_importance) const {
    if (empty()) return {};
    const Node* node = nodes_.data();
    float probability = 1.0f;
    if (node->leaf() && !(leaf_importance(node->index) > 0.0f)) return {};
    while (!node->leaf()) {
      const Node *first = node + 1, *second = &nodes_[node->index];
      const float a = importance_of(*first, p, leaf_importance);
      const float b = importance_of(*second, p, leaf_importance);
      if (!(a + b > 0.0f)) return {};
      const float share = a / (a + b);
      if (u < share) {
        u /= share;
        probability *= share;
        node = first;
      } else {
        u = (u - share) / (1.0f - share);
        probability *= 1.0f - share;
        node = second;
      }
      u = std::clamp(u, 0.0f, kOneMinusEpsilon);
    }
    return {node->index, probability};
  }
  // Exactly the probability that sample() chooses `light` with.
  template <class LeafImportance>
  float probability(const V3f& p, std::uint32_t light, LeafImportance&& leaf_importance) const {
    if (light >= leaf_of_.size() || leaf_of_[light] == kNone) return 0.0f;
    std::uint32_t at = leaf_of_[light];
    if (at == 0) return leaf_importance(light) > 0.0f ? 1.0f : 0.0f;
    float probability = 1.0f;
    while (at != 0) {
      const std::uint32_t parent = nodes_[at].parent;
      const Node &first = nodes_[parent + 1], &second = nodes_[nodes_[parent].index];
      const float a = importance_of(first, p, leaf_importance);
      const float b = importance_of(second, p, leaf_importance);
      if (!(a + b > 0.0f)) return 0.0f;
      const float share = a / (a + b);
      probability *= at == parent + 1 ? share : 1.0f - share;
      at = parent;
    }
    return probability;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  // The first child of an inner node follows it.
  struct Node {
    LightBounds bounds;
    std::uint32_t index;  // of a leaf its light, of an inner node its second child
    std::uint32_t parent;
    bool is_leaf;
    bool leaf() const { return is_leaf; }
  };
  template <class LeafImportance>
  static float importance_of(const Node& node, const V3f& p, LeafImportance&& leaf_importance) {
    return node.leaf() ? leaf_importance(node.index) : node.bounds.importance(p);
  }
  void build(const std::vector<LightBounds>& lights, std::vector<std::uint32_t>& order,
             std::size_t first, std::size_t last, std::uint32_t parent, int depth);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leaf_of_;
};

}  // namespace morsel::render

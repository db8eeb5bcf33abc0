// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/light_tree.h"

#include <array>

namespace morsel::render {
namespace {

constexpr int kBuckets = 12;

// Cost of a set of lights: power times area times how many directions they shine to.
float cost(const LightBounds& b) {
  const float open = std::min(kPi, b.spread + 0.5f * kPi);
  const float orientation =
      2.0f * kPi * (1.0f - std::cos(b.spread)) +
      0.5f * kPi *
          (2.0f * open * std::sin(b.spread) - std::cos(b.spread - 2.0f * open) -
           2.0f * b.spread * std::sin(b.spread) + std::cos(b.spread));
  return b.power * (b.surface_area() + 1e-20f) * std::max(orientation, 1e-3f);
}

V3f middle(const LightBounds& b) { return (b.low + b.high) * 0.5f; }

}  // namespace

LightTree::LightTree(const std::vector<LightBounds>& lights) {
  leaf_of_.assign(lights.size(), kNone);
  std::vector<std::uint32_t> order;
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (lights[i].power > 0.0f) order.push_back(static_cast<std::uint32_t>(i));
  if (order.empty()) return;
  nodes_.reserve(2 * order.size());
  build(lights, order, 0, order.size(), kNone, 0);
}

void LightTree::build(const std::vector<LightBounds>& lights, std::vector<std::uint32_t>& order,
                      std::size_t first, std::size_t last, std::uint32_t parent, int depth) {
  const auto self = static_cast<std::uint32_t>(nodes_.size());
  LightBounds all;
  V3f low(std::numeric_limits<float>::infinity()), high(-std::numeric_limits<float>::infinity());
  for (std::size_t i = first; i < last; ++i) {
    const LightBounds& light = lights[order[i]];
    all = LightBounds::join(all, light);
    const V3f m = middle(light);
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], m[k]);
      high[k] = std::max(high[k], m[k]);
    }
  }
  nodes_.push_back({all, order[first], parent, last - first == 1});
  if (last - first == 1) {
    leaf_of_[order[first]] = self;
    return;
  }

  // The cheapest of the splits between equal slices along each axis.
  const auto slice = [&](std::uint32_t light, int axis) {
    const float width = high[axis] - low[axis];
    const auto k = static_cast<int>((middle(lights[light])[axis] - low[axis]) / width * kBuckets);
    return std::clamp(k, 0, kBuckets - 1);
  };
  float best = std::numeric_limits<float>::infinity();
  int best_axis = -1, best_slice = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(high[axis] > low[axis])) continue;
    std::array<LightBounds, kBuckets> buckets;
    for (std::size_t i = first; i < last; ++i) {
      LightBounds& b = buckets[static_cast<std::size_t>(slice(order[i], axis))];
      b = LightBounds::join(b, lights[order[i]]);
    }
    std::array<float, kBuckets> right_cost{};
    LightBounds right;
    for (std::size_t k = kBuckets - 1; k > 0; --k) {
      right = LightBounds::join(right, buckets[k]);
      right_cost[k] = right.power > 0.0f ? cost(right) : std::numeric_limits<float>::infinity();
    }
    LightBounds left;
    for (std::size_t k = 0; k + 1 < kBuckets; ++k) {
      left = LightBounds::join(left, buckets[k]);
      if (!(left.power > 0.0f)) continue;
      const float c = cost(left) + right_cost[k + 1];
      if (c < best) best = c, best_axis = axis, best_slice = static_cast<int>(k);
    }
  }
  std::size_t split = first + (last - first) / 2;
  // Deep trees of very uneven splits are cut off by halving.
  if (best_axis >= 0 && depth < 48) {
    const auto at =
        std::partition(order.begin() + static_cast<std::ptrdiff_t>(first),
                       order.begin() + static_cast<std::ptrdiff_t>(last),
                       [&](std::uint32_t light) { return slice(light, best_axis) <= best_slice; });
    const auto candidate = static_cast<std::size_t>(at - order.begin());
    if (candidate > first && candidate < last) split = candidate;
  }
  build(lights, order, first, split, self, depth + 1);
  nodes_[self].index = static_cast<std::uint32_t>(nodes_.size());
  build(lights, order, split, last, self, depth + 1);
}

}  // namespace morsel::render

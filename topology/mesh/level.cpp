// SPDX-License-Identifier: Apache-2.0
#include "topology/mesh/level.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "topology/mesh/cell.h"

namespace morsel::topology::meshing {
namespace {

constexpr double kShare = 1e-7;
constexpr double kOverRounding = 4.0;
constexpr double kStep = 1.0 / 1024.0;
// Of the error, what the lowest level may take.
constexpr double kLargestShare = 1.0 / 16.0;

// Evenly spread over the leaves: at most 512, at least 256 where there are as many.
std::vector<Box> some_boxes(const OctreeView& octree, const std::vector<bool>& kept) {
  constexpr std::size_t kMost = 512;
  std::vector<Box> surface, solid;
  std::size_t seen = 0, every = 1;
  octree.for_each_leaf([&](const OctreeView::Leaf& leaf) {
    const OctreeNode& node = octree.nodes[leaf.node];
    const Content content = node.cell_content();
    if (content == Content::kEmpty) return;
    if (node.component >= kept.size() || !kept[node.component]) return;
    if (content == Content::kFull) {  // its faces alone may hold surface
      if (solid.size() < kMost) solid.push_back(leaf.box);
      return;
    }
    if (seen++ % every != 0) return;
    surface.push_back(leaf.box);
    if (surface.size() < kMost) return;
    for (std::size_t i = 0; i < kMost / 2; ++i) surface[i] = surface[2 * i];
    surface.resize(kMost / 2);
    every *= 2;
  });
  return surface.empty() ? solid : surface;
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

double Levels::below(double level) const { return std::max(lowest, kStep * level); }

Levels levels_for(const ScalarField& field, const OctreeView& octree, const std::vector<bool>& kept,
                  double error) {
  std::vector<double> slopes, sides, unknown;
  for (const Box& box : some_boxes(octree, kept)) {
    const Imath::V3d middle = centre(box);
    const LocalModel model = field.model({middle, middle});
    const double slope = model.gradient_at(Imath::V3d(0.0)).length();
    unknown.push_back(model.value_error);
    if (slope > 0.0 && std::isfinite(slope)) slopes.push_back(slope);
    sides.push_back(shortest_side(box));
  }
  const double slope = median(slopes), side = median(sides), rounding = median(unknown);
  Levels levels;
  levels.lowest = kOverRounding * rounding;
  levels.highest = std::max(levels.lowest, kShare * slope * std::min(error, side));
  if (slope > 0.0 && levels.lowest > kLargestShare * error * slope)
    throw std::invalid_argument(
        fmt::format("the error of a mesh must be at least {:.2g} here, not {:.2g}: F is known to "
                    "within {:.2g} and has a slope of {:.2g}",
                    levels.lowest / (kLargestShare * slope), error, rounding, slope));
  return levels;
}

}  // namespace morsel::topology::meshing

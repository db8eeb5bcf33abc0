// SPDX-License-Identifier: Apache-2.0
#include "topology/certified.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "topology/component_table.h"
#include "topology/tree_builder.h"

namespace morsel::topology {
namespace {

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
    // A grid of size / 256 to 512, coarser where the box is so far from the origin that its planes,
    // those through the cells' centres, and one halving more would not be exact.
    constexpr int kHalvings = kMaxDepth + 2;
    const double unit = std::ldexp(
        1.0, std::max(std::ilogb(size) - 8,
                      std::ilogb(reach) - (std::numeric_limits<double>::digits - 1 - kHalvings)));
    result.min[axis] = std::floor(box.min[axis] / unit) * unit;
    result.max[axis] = std::ceil(box.max[axis] / unit) * unit;
    if (result.max[axis] == result.min[axis]) result.max[axis] += unit;
  }
  return result;
}

NotFinite::NotFinite(const Imath::V3d& place, double value)
    : std::runtime_error(
          std::isfinite(value)
              ? fmt::format(
                    "near ({:.6g}, {:.6g}, {:.6g}) the field is {:.6g}, but no bounds of it "
                    "are known however small a box: its parameters are too large",
                    place.x, place.y, place.z, value)
              : fmt::format("the field is not finite at ({:.6g}, {:.6g}, {:.6g}) but {}: its "
                            "parameters are too large",
                            place.x, place.y, place.z, value)) {}

Topology certify(const ScalarField& field, const CertifyOptions& options,
                 const Execution& execution) {
  if (options.min_depth < 0 || options.max_depth > kMaxDepth ||
      options.min_depth > options.max_depth)
    throw std::invalid_argument(
        fmt::format("depths must satisfy 0 <= min_depth <= max_depth <= {}", kMaxDepth));
  Topology topology;
  topology.box = dyadic_box(options.box);
  TreeBuilder builder(field, topology.box, options, execution);
  Forest forest = builder.build();
  topology.models = builder.models();
  label_components(field, forest, execution, topology);
  topology.nodes = forest.assemble();
  return topology;
}

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#include "topology/component_bounds.h"

#include <algorithm>
#include <limits>

namespace morsel::topology {
namespace {

// How many local maxima of F an undecided cell can hold at most: 0, 1, or -1 for "no bound".
int possible_maxima(const ScalarField& field, const Box& box) {
  const LocalModel model = field.model(box);
  for (int i = 0; i < 3; ++i) {
    const Interval slope = model.gradient_range(i);
    if (slope.lo > 0.0 || slope.hi < 0.0) return 0;
    if (model.hessian_range(i, i).lo > 0.0) return 0;  // curved upwards along an axis: no maximum
  }
  // Diagonally dominant and negative: strictly concave on the cell, at most one maximum
  // (Gershgorin).
  for (int i = 0; i < 3; ++i) {
    double reach = 0.0;
    for (int j = 0; j < 3; ++j)
      if (j != i) reach += model.hessian_range(i, j).magnitude();
    if (model.hessian_range(i, i).hi + reach >= 0.0) return -1;
  }
  return 1;
}

// What may belong to one component.
struct Reach {
  Box bounds;
  double volume = 0.0;
  std::uint64_t terms = 0;  // that were added up
};

double volume_of(const Box& box) {
  const Imath::V3d size = box.max - box.min;
  return size.x * size.y * size.z;
}

}  // namespace

CountBounds bound_components(const ScalarField& field, const Undecided& undecided,
                             const UnionFind& joined, const std::vector<std::uint32_t>& row_of,
                             bool touches_box, std::vector<Component>& rows) {
  const std::size_t pieces = row_of.size();
  UnionFind possible = joined;
  for (const auto& [a, b] : undecided.joins) possible.unite(a, b);

  CountBounds count;
  std::vector<bool> holds_solid(pieces, false);
  std::vector<std::uint32_t> set_of_row(rows.size(), 0);
  for (std::uint32_t i = 0; i < pieces; ++i) {
    if (undecided.is_cell[i]) continue;
    holds_solid[possible.find(i)] = true;
    set_of_row[row_of[i]] = possible.find(i);
  }
  count.lo = static_cast<std::uint64_t>(std::count(holds_solid.begin(), holds_solid.end(), true));

  count.hi = rows.size();
  for (const auto& [piece, box] : undecided.cells) {
    // A maximum on the domain's own boundary need not be a critical point.
    const int maxima = touches_box ? -1 : possible_maxima(field, box);
    if (maxima < 0) {
      count.hi.reset();
      break;
    }
    *count.hi += static_cast<std::uint64_t>(maxima);
  }

  std::vector<Reach> reach(pieces);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    Reach& set = reach[set_of_row[r]];
    set.bounds.extendBy(rows[r].bounds);
    set.volume += rows[r].volume_hi;
    set.terms += rows[r].cells;
  }
  for (const auto& [piece, box] : undecided.cells) {
    Reach& set = reach[possible.find(piece)];
    set.bounds.extendBy(box);
    set.volume += volume_of(box);
    ++set.terms;
  }
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Reach& set = reach[set_of_row[r]];
    Component& c = rows[r];
    c.bounds = set.bounds;
    c.volume_lo -= kEpsilon * static_cast<double>(c.cells) * c.volume_lo;
    c.volume_hi = set.volume * (1.0 + kEpsilon * static_cast<double>(set.terms + 2));
  }
  return count;
}

}  // namespace morsel::topology

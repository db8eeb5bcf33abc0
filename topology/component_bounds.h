// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "topology/components.h"
#include "topology/scalar_field.h"
#include "topology/union_find.h"

namespace morsel::topology {

// What stayed undecided in a labelled octree, in terms of its pieces: sets of certainly joined
// cells, and every undecided cell by itself.
struct Undecided {
  std::vector<bool> is_cell;                                   // piece by piece
  std::vector<std::pair<std::uint32_t, Box>> cells;            // such a piece and its cell
  std::vector<std::pair<std::uint32_t, std::uint32_t>> joins;  // pieces that may be joined
};

struct CountBounds {
  std::uint64_t lo = 0;
  std::optional<std::uint64_t> hi;  // empty: no bound is known
};

// Bounds of the number of components, and of the components themselves: topology/README.md says
// why they hold. `joined` has the pieces that are certainly joined; `row_of[piece]` is the row
// that a piece which holds solid belongs to. `rows` come with the sums of their own cells; the
// upper bounds of volumes, and the boxes, are widened to all that may belong to the same
// component, and volumes rounded outward. `touches_box`: the box may cut the solid.
CountBounds bound_components(const ScalarField& field, const Undecided& undecided,
                             const UnionFind& joined, const std::vector<std::uint32_t>& row_of,
                             bool touches_box, std::vector<Component>& rows);

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "topology/mesh/cell_set.h"

namespace morsel::topology::meshing {

// F at the corners of all cells. Each corner is evaluated once, by the first cell that has it, so
// that cells agree on its sign.
class Corners {
 public:
  Corners(const CellSet& cells, const Execution& execution);

  // Whether corner i of the cell is in S.
  bool inside(std::uint32_t cell, unsigned i) const { return inside_[id_[8u * cell + i]] != 0; }
  // Bit i: inside(cell, i).
  unsigned mask(std::uint32_t cell) const {
    unsigned m = 0;
    for (unsigned i = 0; i < 8; ++i) m |= static_cast<unsigned>(inside(cell, i)) << i;
    return m;
  }
  double value(std::uint32_t cell, unsigned i) const { return values_[id_[8u * cell + i]]; }
  void flip(std::uint32_t cell, unsigned i) { inside_[id_[8u * cell + i]] ^= 1u; }

 private:
  std::vector<std::uint32_t> id_;  // 8 a cell
  std::vector<double> values_;
  std::vector<std::uint8_t> inside_;
};

}  // namespace morsel::topology::meshing

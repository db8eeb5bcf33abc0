// SPDX-License-Identifier: Apache-2.0
#include "topology/mesh/corners.h"

#include <tbb/parallel_sort.h>

#include <tuple>

#include "topology/mesh/parallel.h"

namespace morsel::topology::meshing {

Corners::Corners(const CellSet& cells, const Execution& execution)
    : id_(std::size_t{8} * cells.size()) {
  struct Record {
    GridPoint point;
    std::uint32_t slot;  // 8 cell + corner
    bool operator<(const Record& o) const {
      return std::tie(point, slot) < std::tie(o.point, o.slot);
    }
  };
  std::vector<Record> records(id_.size());
  for_pieces(cells.size(), execution, nullptr, [&](std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c)
      for (unsigned i = 0; i < 8; ++i)
        records[8 * c + i] = {cells[static_cast<std::uint32_t>(c)].corner(i),
                              static_cast<std::uint32_t>(8 * c + i)};
  });
  tbb::parallel_sort(records.begin(), records.end());
  execution.check_cancel();
  std::vector<std::uint32_t> owner;  // slot of each distinct corner's first cell
  for (std::size_t r = 0; r < records.size(); ++r) {
    if (r == 0 || records[r].point != records[r - 1].point) owner.push_back(records[r].slot);
    id_[records[r].slot] = static_cast<std::uint32_t>(owner.size() - 1);
  }
  values_.resize(owner.size());
  inside_.resize(owner.size());
  for_pieces(owner.size(), execution, "corners", [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const std::uint32_t cell = owner[k] / 8;
      values_[k] = cells.field(cell).value(cells.grid().point(cells[cell].corner(owner[k] % 8)));
      inside_[k] = values_[k] >= 0.0 ? 1 : 0;
    }
  });
}

}  // namespace morsel::topology::meshing

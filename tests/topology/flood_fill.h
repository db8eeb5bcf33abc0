// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/parallel_for.h>

#include <cstdint>
#include <vector>

#include "topology/scalar_field.h"
#include "topology/union_find.h"

namespace morsel::topology::testing {

// Components of {F >= 0} on a grid of n^3 points, 6-neighbours: slow, independent of the octree,
// and right only where the grid resolves the field.
inline int flood_fill(const ScalarField& field, const Box& box, int n) {
  const Imath::V3d step = (box.max - box.min) / n;
  std::vector<std::uint8_t> inside(static_cast<std::size_t>(n) * n * n);
  const auto index = [n](int i, int j, int k) {
    return (static_cast<std::size_t>(k) * n + j) * n + i;
  };
  constexpr int kBlock = 16;
  const int blocks = (n + kBlock - 1) / kBlock;
  tbb::parallel_for(0, blocks * blocks * blocks, [&](int b) {
    const int first[3] = {b % blocks * kBlock, b / blocks % blocks * kBlock,
                          b / (blocks * blocks) * kBlock};
    const Imath::V3d corner = box.min + step * Imath::V3d(first[0], first[1], first[2]);
    const auto local = field.restricted_to(Box(corner, corner + step * double{kBlock}));
    for (int k = first[2]; k < std::min(n, first[2] + kBlock); ++k)
      for (int j = first[1]; j < std::min(n, first[1] + kBlock); ++j)
        for (int i = first[0]; i < std::min(n, first[0] + kBlock); ++i)
          inside[index(i, j, k)] =
              local->value(box.min + step * Imath::V3d(i + 0.5, j + 0.5, k + 0.5)) >= 0.0;
  });
  UnionFind sets(inside.size());
  const auto join = [&](std::size_t a, std::size_t b) {
    if (inside[a] && inside[b])
      sets.unite(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
  };
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        if (i + 1 < n) join(index(i, j, k), index(i + 1, j, k));
        if (j + 1 < n) join(index(i, j, k), index(i, j + 1, k));
        if (k + 1 < n) join(index(i, j, k), index(i, j, k + 1));
      }
  int count = 0;
  for (std::size_t c = 0; c < inside.size(); ++c)
    count += inside[c] && sets.find(static_cast<std::uint32_t>(c)) == c;
  return count;
}

}  // namespace morsel::topology::testing

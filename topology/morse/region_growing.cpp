// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/region_growing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <stdexcept>
#include <vector>

#include "topology/morse/sign_slabs.h"

namespace morsel::topology {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

// Disjoint sets that grow; counts them.
class Regions {
 public:
  std::uint32_t add() {
    parent_.push_back(static_cast<std::uint32_t>(parent_.size()));
    ++count_;
    return parent_.back();
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return;
    parent_[std::max(a, b)] = std::min(a, b);
    --count_;
  }
  std::uint64_t count() const { return count_; }

 private:
  std::vector<std::uint32_t> parent_;
  std::uint64_t count_ = 0;
};

void check_resolution(int n) {
  if (n < 2 || n > kMaxGridResolution)
    throw std::invalid_argument(fmt::format(
        "the resolution of the grid must lie in 2 ... {}, not {}", kMaxGridResolution, n));
}

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Signs of the eight corners of voxel (i, j), bit x + 2 y + 4 z.
unsigned corner_signs(SignLayer below, SignLayer above, std::size_t at, std::size_t side) {
  return static_cast<unsigned>(below[at] | below[at + 1] << 1 | below[at + side] << 2 |
                               below[at + side + 1] << 3 | above[at] << 4 | above[at + 1] << 5 |
                               above[at + side] << 6 | above[at + side + 1] << 7);
}

// A tetrahedron of Freudenthal's triangulation: the corners on a path from corner 0 to corner 7.
constexpr std::array<std::array<unsigned, 4>, 6> kTetrahedra = {
    {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};

// Mesh vertices on the edges that start at the corners of two layers: [corner][direction - 1], the
// direction a set of axes as bits.
class EdgeLabels {
 public:
  explicit EdgeLabels(std::size_t corners)
      : lower_(7 * corners, kNone), upper_(7 * corners, kNone) {}
  std::uint32_t& at(bool upper, std::size_t corner, unsigned direction) {
    return (upper ? upper_ : lower_)[7 * corner + direction - 1];
  }
  void step() {
    lower_.swap(upper_);
    std::fill(upper_.begin(), upper_.end(), kNone);
  }

 private:
  std::vector<std::uint32_t> lower_, upper_;
};

}  // namespace

RegionCount grow_voxel_regions(const ScalarField& field, const Box& box, int n,
                               const Execution& execution) {
  check_resolution(n);
  const Stopwatch watch;
  const auto voxels = static_cast<std::size_t>(n);
  RegionCount result;
  Regions regions;
  std::vector<std::uint32_t> below(voxels * voxels, kNone), here(voxels * voxels, kNone);
  result.evaluations =
      for_each_sign_slab(field, box, n, execution, [&](int, SignLayer low, SignLayer high) {
        for (std::size_t j = 0; j < voxels; ++j)
          for (std::size_t i = 0; i < voxels; ++i) {
            const std::size_t at = j * voxels + i;
            std::uint32_t label = kNone;
            if (corner_signs(low, high, j * (voxels + 1) + i, voxels + 1) != 0) {
              ++result.elements;
              for (const std::uint32_t other :
                   {i > 0 ? here[at - 1] : kNone, j > 0 ? here[at - voxels] : kNone, below[at]}) {
                if (other == kNone) continue;
                if (label == kNone)
                  label = other;
                else
                  regions.unite(label, other);
              }
              if (label == kNone) label = regions.add();
            }
            here[at] = label;
          }
        below.swap(here);
      });
  result.components = regions.count();
  result.seconds = watch.seconds();
  return result;
}

RegionCount grow_mesh_regions(const ScalarField& field, const Box& box, int n,
                              const Execution& execution) {
  check_resolution(n);
  const Stopwatch watch;
  const auto voxels = static_cast<std::size_t>(n);
  const std::size_t side = voxels + 1;
  RegionCount result;
  Regions regions;
  EdgeLabels labels(side * side);
  const auto visit_voxel = [&](std::size_t corner, unsigned signs) {
    for (const auto& tetrahedron : kTetrahedra) {
      std::uint32_t first = kNone;
      int crossings = 0;
      for (unsigned a = 0; a < 4; ++a)
        for (unsigned b = a + 1; b < 4; ++b) {
          const unsigned from = tetrahedron[a], to = tetrahedron[b];
          if (((signs >> from) & 1u) == ((signs >> to) & 1u)) continue;
          std::uint32_t& label = labels.at(
              (from & 4u) != 0, corner + (from & 1u) + (from & 2u) / 2u * side, to ^ from);
          if (label == kNone) label = regions.add();
          ++crossings;
          if (first == kNone)
            first = label;
          else
            regions.unite(first, label);
        }
      result.elements += crossings == 0 ? 0u : static_cast<unsigned>(crossings) - 2u;
    }
  };
  result.evaluations =
      for_each_sign_slab(field, box, n, execution, [&](int k, SignLayer low, SignLayer high) {
        if (k > 0) labels.step();
        for (std::size_t j = 0; j < voxels; ++j)
          for (std::size_t i = 0; i < voxels; ++i) {
            const std::size_t corner = j * side + i;
            const unsigned signs = corner_signs(low, high, corner, side);
            if (signs != 0 && signs != 255) visit_voxel(corner, signs);
          }
      });
  result.components = regions.count();
  result.seconds = watch.seconds();
  return result;
}

}  // namespace morsel::topology

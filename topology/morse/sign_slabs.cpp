// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/sign_slabs.h"

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <vector>

namespace morsel::topology {
namespace {

constexpr int kBlock = 16;  // samples along a side of a block

class Sampler {
 public:
  Sampler(const ScalarField& field, const Box& box, int n)
      : field_(field), box_(box), n_(n), side_(static_cast<std::size_t>(n) + 1) {}

  // Layers first ... first + count - 1 into `signs`.
  void fill(int first, int count, std::vector<std::uint8_t>& signs) {
    const int blocks = (n_ + kBlock) / kBlock;
    tbb::parallel_for(tbb::blocked_range2d<int>(0, blocks, 1, 0, blocks, 4),
                      [&](const tbb::blocked_range2d<int>& range) {
                        for (int bj = range.rows().begin(); bj != range.rows().end(); ++bj)
                          for (int bi = range.cols().begin(); bi != range.cols().end(); ++bi)
                            fill_block(bi * kBlock, bj * kBlock, first, count, signs);
                      });
  }

  std::uint64_t evaluations() const { return evaluations_; }

 private:
  Imath::V3d corner(int i, int j, int k) const {
    return box_.min + (box_.max - box_.min) * Imath::V3d(i, j, k) / n_;
  }

  void fill_block(int i0, int j0, int first, int count, std::vector<std::uint8_t>& signs) {
    const int i1 = std::min(i0 + kBlock, n_ + 1), j1 = std::min(j0 + kBlock, n_ + 1);
    const auto row = [&](int j, int k) {
      return signs.begin() +
             static_cast<std::ptrdiff_t>(
                 (static_cast<std::size_t>(k) * side_ + static_cast<std::size_t>(j)) * side_);
    };
    Box block(corner(i0, j0, first), corner(i1 - 1, j1 - 1, first + count - 1));
    // Rounding of the corners must not lead out of the block.
    const Imath::V3d margin((box_.max - box_.min) * 1e-12);
    block.min -= margin;
    block.max += margin;
    const Interval range = field_.model(block).range();
    if (range.hi < 0.0 || range.lo >= 0.0) {
      for (int k = 0; k < count; ++k)
        for (int j = j0; j < j1; ++j)
          std::fill(row(j, k) + i0, row(j, k) + i1, static_cast<std::uint8_t>(range.lo >= 0.0));
      return;
    }
    const std::unique_ptr<ScalarField> local = field_.restricted_to(block);
    for (int k = 0; k < count; ++k)
      for (int j = j0; j < j1; ++j)
        for (int i = i0; i < i1; ++i) row(j, k)[i] = local->value(corner(i, j, first + k)) >= 0.0;
    evaluations_ += static_cast<std::uint64_t>(count) * static_cast<std::uint64_t>(j1 - j0) *
                    static_cast<std::uint64_t>(i1 - i0);
  }

  const ScalarField& field_;
  Box box_;
  int n_;
  std::size_t side_;
  std::atomic<std::uint64_t> evaluations_{0};
};

}  // namespace

std::uint64_t for_each_sign_slab(const ScalarField& field, const Box& box, int n,
                                 const Execution& execution,
                                 const std::function<void(int, SignLayer, SignLayer)>& visit) {
  const std::size_t layer = (static_cast<std::size_t>(n) + 1) * (static_cast<std::size_t>(n) + 1);
  Sampler sampler(field, box, n);
  std::vector<std::uint8_t> signs(layer * kBlock), last(layer);
  for (int first = 0; first <= n; first += kBlock) {
    execution.check_cancel();
    if (execution.progress) execution.progress(first / (n + 1.0), "sampling");
    const int count = std::min(kBlock, n + 1 - first);
    sampler.fill(first, count, signs);
    const auto at = [&](int k) {
      return SignLayer(signs).subspan(layer * static_cast<std::size_t>(k), layer);
    };
    if (first > 0) visit(first - 1, last, at(0));
    for (int k = 0; k + 1 < count; ++k) visit(first + k, at(k), at(k + 1));
    std::copy_n(at(count - 1).begin(), layer, last.begin());
  }
  return sampler.evaluations();
}

}  // namespace morsel::topology

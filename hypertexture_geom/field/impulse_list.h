// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstddef>
#include <vector>

namespace morsel::geom {

// An impulse in object space: weight * max(0, 1 - inverse_square * |x - centre|^2)^3. These doubles
// *are* the field's definition; nothing is rounded behind them.
struct Impulse {
  Imath::V3d centre;
  double inverse_square = 0.0;
  double weight = 0.0;
};

// Eight impulses side by side, as the SIMD evaluator reads them. Unused places have weight 0.
struct ImpulseBlock {
  static constexpr std::size_t kSize = 8;
  double x[kSize] = {}, y[kSize] = {}, z[kSize] = {}, inverse_square[kSize] = {},
         weight[kSize] = {};
};

// Impulses in order of insertion.
class ImpulseList {
 public:
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  void reserve(std::size_t count) {
    blocks_.reserve((count + ImpulseBlock::kSize - 1) / ImpulseBlock::kSize);
  }

  Impulse operator[](std::size_t i) const {
    const ImpulseBlock& b = blocks_[i / ImpulseBlock::kSize];
    const std::size_t k = i % ImpulseBlock::kSize;
    return {Imath::V3d(b.x[k], b.y[k], b.z[k]), b.inverse_square[k], b.weight[k]};
  }

  double inverse_square(std::size_t i) const {
    return blocks_[i / ImpulseBlock::kSize].inverse_square[i % ImpulseBlock::kSize];
  }

  void push_back(const Impulse& p) {
    const std::size_t k = size_ % ImpulseBlock::kSize;
    if (k == 0) blocks_.emplace_back();
    ImpulseBlock& b = blocks_.back();
    b.x[k] = p.centre.x;
    b.y[k] = p.centre.y;
    b.z[k] = p.centre.z;
    b.inverse_square[k] = p.inverse_square;
    b.weight[k] = p.weight;
    ++size_;
  }

  // Places of the last block that are not used have weight 0.
  const ImpulseBlock* blocks() const { return blocks_.data(); }
  std::size_t block_count() const { return blocks_.size(); }

  void append(const ImpulseList& other);

  // Of those impulses that are not 0 on all of the box |u_i| <= half_i about `centre` (a few that
  // are by a rounding may be among them), appends to `whole` those whose kernels hold all of it:
  // there they are weight * (1 - inverse_square * |x - centre|^2)^3. The others go to `cut`, which
  // may be the same list.
  void sort(const Imath::V3d& centre, const Imath::V3d& half, ImpulseList& whole,
            ImpulseList& cut) const;

  // Sum of all impulses at `x`, evaluated with the machine's widest vectors (Highway picks at run
  // time). The order of summation follows the vector width: results of two machines may differ by a
  // few roundings.
  double value(const Imath::V3d& x) const;

 private:
  std::vector<ImpulseBlock> blocks_;
  std::size_t size_ = 0;
};

}  // namespace morsel::geom

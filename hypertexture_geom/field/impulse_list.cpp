// SPDX-License-Identifier: Apache-2.0
// Compiled by Highway for every instruction set and picked at run time: the file is included once
// for each target. (Everything but sums of impulses in double precision: tape_kernels.cpp.)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hypertexture_geom/field/impulse_list.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include <cstdint>

#include "hypertexture_geom/field/impulse_list.h"

#ifndef MORSEL_FIELD_IMPULSE_LIST_REACH_
#define MORSEL_FIELD_IMPULSE_LIST_REACH_
namespace morsel::geom {
namespace {

// Bit i of a byte for place i of a block: whether the impulse reaches the box, and whether its
// kernel holds all of it. Places that are not used may be set.
struct Reach {
  std::uint8_t some, all;
};

}  // namespace
}  // namespace morsel::geom
#endif

HWY_BEFORE_NAMESPACE();
namespace morsel::geom::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

double sum_impulses(const ImpulseBlock* blocks, std::size_t count, double px, double py,
                    double pz) {
  const hn::CappedTag<double, ImpulseBlock::kSize> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto x = hn::Set(d, px), y = hn::Set(d, py), z = hn::Set(d, pz);
  const auto one = hn::Set(d, 1.0), zero = hn::Zero(d);
  auto sum = zero;
  for (std::size_t b = 0; b < count; ++b) {
    const ImpulseBlock& block = blocks[b];
    for (std::size_t i = 0; i < ImpulseBlock::kSize; i += lanes) {
      const auto dx = hn::Sub(x, hn::LoadU(d, block.x + i));
      const auto dy = hn::Sub(y, hn::LoadU(d, block.y + i));
      const auto dz = hn::Sub(z, hn::LoadU(d, block.z + i));
      const auto square = hn::MulAdd(dz, dz, hn::MulAdd(dy, dy, hn::Mul(dx, dx)));
      const auto q =
          hn::Max(zero, hn::NegMulAdd(square, hn::LoadU(d, block.inverse_square + i), one));
      sum = hn::MulAdd(hn::Mul(hn::LoadU(d, block.weight + i), q), hn::Mul(q, q), sum);
    }
  }
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

Reach reach_of(const ImpulseBlock& block, const double* centre, const double* half) {
  // Relative slack on squared distances: far above their rounding. A kernel that holds a box will
  // be asked of boxes in it whose corners are rounded otherwise.
  constexpr double kSlack = 1e-12, kMargin = 1e-9;
  const hn::CappedTag<double, ImpulseBlock::kSize> d;
  const std::size_t lanes = hn::Lanes(d);
  const double* const coordinates[3] = {block.x, block.y, block.z};
  const auto zero = hn::Zero(d);
  unsigned some = 0, all = 0;
  for (std::size_t i = 0; i < ImpulseBlock::kSize; i += lanes) {
    auto nearest = zero, farthest = zero;  // squared distances
    for (int axis = 0; axis < 3; ++axis) {
      const auto extent = hn::Set(d, half[axis]);
      const auto away =
          hn::Abs(hn::Sub(hn::Set(d, centre[axis]), hn::LoadU(d, coordinates[axis] + i)));
      const auto low = hn::Max(zero, hn::Sub(away, extent)), high = hn::Add(away, extent);
      nearest = hn::MulAdd(low, low, nearest);
      farthest = hn::MulAdd(high, high, farthest);
    }
    const auto s = hn::LoadU(d, block.inverse_square + i);
    std::uint8_t mask[8] = {};
    hn::StoreMaskBits(d, hn::Lt(hn::Mul(s, nearest), hn::Set(d, 1.0 + kSlack)), mask);
    some |= static_cast<unsigned>(mask[0]) << i;
    hn::StoreMaskBits(d, hn::Lt(hn::Mul(s, farthest), hn::Set(d, 1.0 - kMargin)), mask);
    all |= static_cast<unsigned>(mask[0]) << i;
  }
  return {static_cast<std::uint8_t>(some), static_cast<std::uint8_t>(all)};
}

void find_reach(const ImpulseBlock* blocks, std::size_t count, const double* centre,
                const double* half, Reach* reach) {
  for (std::size_t b = 0; b < count; ++b) reach[b] = reach_of(blocks[b], centre, half);
}

}  // namespace morsel::geom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <bit>

namespace morsel::geom {

HWY_EXPORT(sum_impulses);
HWY_EXPORT(find_reach);

double ImpulseList::value(const Imath::V3d& x) const {
  return HWY_DYNAMIC_DISPATCH(sum_impulses)(blocks_.data(), blocks_.size(), x.x, x.y, x.z);
}

void ImpulseList::append(const ImpulseList& other) {
  reserve(size_ + other.size_);
  if (size_ % ImpulseBlock::kSize == 0) {
    blocks_.insert(blocks_.end(), other.blocks_.begin(), other.blocks_.end());
    size_ += other.size_;
    return;
  }
  for (std::size_t n = 0; n < other.size_; ++n) push_back(other[n]);
}

void ImpulseList::sort(const Imath::V3d& centre, const Imath::V3d& half, ImpulseList& whole,
                       ImpulseList& cut) const {
  constexpr std::size_t kChunk = 64;  // blocks at a time
  if (blocks_.size() <= kChunk) cut.reserve(cut.size() + size_);
  Reach reach[kChunk];
  for (std::size_t first = 0; first < blocks_.size(); first += kChunk) {
    const std::size_t count = std::min(kChunk, blocks_.size() - first);
    HWY_DYNAMIC_DISPATCH(find_reach)
    (blocks_.data() + first, count, &centre.x, &half.x, reach);
    for (std::size_t b = 0; b < count; ++b) {
      const std::size_t start = (first + b) * ImpulseBlock::kSize;
      unsigned here = reach[b].some;
      if (size_ - start < ImpulseBlock::kSize) here &= (1u << (size_ - start)) - 1u;
      for (; here != 0; here &= here - 1) {
        const int place = std::countr_zero(here);
        const bool all = (reach[b].all >> place & 1u) != 0;
        (all ? whole : cut).push_back((*this)[start + static_cast<std::size_t>(place)]);
      }
    }
  }
}

}  // namespace morsel::geom
#endif

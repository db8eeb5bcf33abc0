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

// Bit i of the result for place i of the block; places that are not used may be set.
unsigned reaching_bits(const ImpulseBlock& block, const double* centre, const double* half) {
  // Relative slack on squared distances: far above their rounding.
  constexpr double kSlack = 1e-12;
  const hn::CappedTag<double, ImpulseBlock::kSize> d;
  const std::size_t lanes = hn::Lanes(d);
  const double* const coordinates[3] = {block.x, block.y, block.z};
  const auto zero = hn::Zero(d);
  unsigned bits = 0;
  for (std::size_t i = 0; i < ImpulseBlock::kSize; i += lanes) {
    auto nearest = zero;  // squared distance from the box
    for (int axis = 0; axis < 3; ++axis) {
      const auto away =
          hn::Abs(hn::Sub(hn::Set(d, centre[axis]), hn::LoadU(d, coordinates[axis] + i)));
      const auto low = hn::Max(zero, hn::Sub(away, hn::Set(d, half[axis])));
      nearest = hn::MulAdd(low, low, nearest);
    }
    const auto near = hn::Mul(hn::LoadU(d, block.inverse_square + i), nearest);
    std::uint8_t mask[8] = {};
    hn::StoreMaskBits(d, hn::Lt(near, hn::Set(d, 1.0 + kSlack)), mask);
    bits |= static_cast<unsigned>(mask[0]) << i;
  }
  return bits;
}

void find_reaching(const ImpulseBlock* blocks, std::size_t count, const double* centre,
                   const double* half, std::uint8_t* bits) {
  for (std::size_t b = 0; b < count; ++b)
    bits[b] = static_cast<std::uint8_t>(reaching_bits(blocks[b], centre, half));
}

}  // namespace morsel::geom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <bit>

namespace morsel::geom {

HWY_EXPORT(sum_impulses);
HWY_EXPORT(find_reaching);

double ImpulseList::value(const Imath::V3d& x) const {
  return HWY_DYNAMIC_DISPATCH(sum_impulses)(blocks_.data(), blocks_.size(), x.x, x.y, x.z);
}

void ImpulseList::append_reaching(const ImpulseList& from, const Imath::V3d& centre,
                                  const Imath::V3d& half) {
  constexpr std::size_t kChunk = 64;  // blocks at a time
  std::uint8_t bits[kChunk];
  for (std::size_t first = 0; first < from.blocks_.size(); first += kChunk) {
    const std::size_t count = std::min(kChunk, from.blocks_.size() - first);
    HWY_DYNAMIC_DISPATCH(find_reaching)
    (from.blocks_.data() + first, count, &centre.x, &half.x, bits);
    for (std::size_t b = 0; b < count; ++b) {
      const std::size_t start = (first + b) * ImpulseBlock::kSize;
      unsigned here = bits[b];
      if (from.size_ - start < ImpulseBlock::kSize) here &= (1u << (from.size_ - start)) - 1u;
      for (; here != 0; here &= here - 1)
        push_back(from[start + static_cast<std::size_t>(std::countr_zero(here))]);
    }
  }
}

}  // namespace morsel::geom
#endif

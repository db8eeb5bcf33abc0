// SPDX-License-Identifier: Apache-2.0
// Compiled by Highway for every instruction set and picked at run time: the file is included once
// for each target. (Everything but sums of impulses in double precision: tape_kernels.cpp.)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hypertexture_geom/field/impulse_list.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

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

}  // namespace morsel::geom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace morsel::geom {

HWY_EXPORT(sum_impulses);

double ImpulseList::value(const Imath::V3d& x) const {
  return HWY_DYNAMIC_DISPATCH(sum_impulses)(blocks_.data(), blocks_.size(), x.x, x.y, x.z);
}

}  // namespace morsel::geom
#endif

// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hypertexture_geom/field/impulse_range.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include <cstddef>
#include <memory>

#include "hypertexture_geom/field/impulse_range.h"

#ifndef MORSEL_FIELD_IMPULSE_RANGE_TYPES_
#define MORSEL_FIELD_IMPULSE_RANGE_TYPES_
namespace morsel::geom {
namespace {

constexpr int kMostParts = 4;    // along an axis
constexpr std::size_t kPad = 8;  // at least a vector of doubles

// Impulses of one radius whose weights have one sign, relative to a box's centre: `count` of them,
// then kPad of weight 0.
struct Batch {
  double *x, *y, *z, *weight;
  std::size_t count;
};

// What is known of all of them.
struct Gathered {
  Batch positive, negative;
  double gradient[3];
  double weights;
};

// Parts of a box: along each axis `count` intervals of half width `half` about `offset` from the
// box's centre.
struct Grid {
  int count[3];
  double offset[3][kMostParts];
  double half[3];
};

// Distances are rounded by less than 10^-13 of ten radii: added to what q may be at most.
constexpr double kTop = 1.0 + 1e-10;

}  // namespace
}  // namespace morsel::geom
#endif

HWY_BEFORE_NAMESPACE();
namespace morsel::geom::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<double, kPad>;
using Vector = hn::Vec<Tag>;

HWY_INLINE double sum_of(Vector v) { return hn::GetLane(hn::SumOfLanes(Tag(), v)); }

template <class M>
HWY_INLINE void append(const M& mask, const Vector (&p)[3], Vector weight, Batch& out) {
  const Tag d;
  hn::CompressStore(p[0], mask, d, out.x + out.count);
  hn::CompressStore(p[1], mask, d, out.y + out.count);
  hn::CompressStore(p[2], mask, d, out.z + out.count);
  out.count += hn::CompressStore(weight, mask, d, out.weight + out.count);
}

HWY_INLINE void end(Batch& out) {
  for (std::size_t i = 0; i < kPad; ++i)
    out.x[out.count + i] = out.y[out.count + i] = out.z[out.count + i] = out.weight[out.count + i] =
        0.0;
}

// Those of `blocks` that reach the box.
void gather(const ImpulseBlock* blocks, std::size_t count, const double* centre, const double* half,
            Gathered& out) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const double square = blocks[0].inverse_square[0];
  const auto s = hn::Set(d, square), zero = hn::Zero(d), top = hn::Set(d, kTop);
  // |dK/dx_i| = 6 s |d_i| q^2, and never more than 1.7173 sqrt(s).
  const auto steep = hn::Set(d, 6.0 * square), steepest = hn::Sqrt(hn::Set(d, 2.9494 * square));
  auto weights = zero;
  Vector gradient[3] = {zero, zero, zero};
  for (std::size_t b = 0; b < count; ++b) {
    const ImpulseBlock& block = blocks[b];
    const double* const coordinates[3] = {block.x, block.y, block.z};
    for (std::size_t i = 0; i < ImpulseBlock::kSize; i += lanes) {
      Vector from[3], reach[3];
      auto nearest = zero;
      for (int axis = 0; axis < 3; ++axis) {
        const auto extent = hn::Set(d, half[axis]);
        from[axis] = hn::Sub(hn::LoadU(d, coordinates[axis] + i), hn::Set(d, centre[axis]));
        const auto away = hn::Abs(from[axis]), low = hn::Max(zero, hn::Sub(away, extent));
        nearest = hn::Add(nearest, hn::Mul(low, low));
        reach[axis] = hn::Add(away, extent);
      }
      const auto q = hn::Sub(top, hn::Mul(s, nearest));
      const auto near = hn::Gt(q, zero);
      if (hn::AllFalse(d, near)) continue;
      const auto weight = hn::IfThenElseZero(near, hn::LoadU(d, block.weight + i));
      const auto size = hn::Abs(weight);
      weights = hn::Add(weights, size);
      const auto slope = hn::Mul(steep, hn::Mul(q, q));
      for (int axis = 0; axis < 3; ++axis)
        gradient[axis] =
            hn::Add(gradient[axis], hn::Mul(size, hn::Min(hn::Mul(slope, reach[axis]), steepest)));
      append(hn::Gt(weight, zero), from, size, out.positive);
      append(hn::Lt(weight, zero), from, size, out.negative);
    }
  }
  end(out.positive);
  end(out.negative);
  for (int axis = 0; axis < 3; ++axis) out.gradient[axis] = sum_of(gradient[axis]);
  out.weights = sum_of(weights);
}

// Those of a batch that reach a part of its box.
void choose(const Batch& from, double square, const double* offset, const double* half,
            Batch& out) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const auto s = hn::Set(d, square), zero = hn::Zero(d), top = hn::Set(d, kTop);
  for (std::size_t i = 0; i < from.count; i += lanes) {
    const Vector p[3] = {hn::LoadU(d, from.x + i), hn::LoadU(d, from.y + i),
                         hn::LoadU(d, from.z + i)};
    auto nearest = zero;
    for (int axis = 0; axis < 3; ++axis) {
      const auto away = hn::Abs(hn::Sub(p[axis], hn::Set(d, offset[axis])));
      const auto low = hn::Max(zero, hn::Sub(away, hn::Set(d, half[axis])));
      nearest = hn::Add(nearest, hn::Mul(low, low));
    }
    const auto near = hn::Lt(hn::Mul(s, nearest), top);
    append(hn::And(near, hn::FirstN(d, from.count - i)), p, hn::LoadU(d, from.weight + i), out);
  }
  end(out);
}

// The largest sum over a part of what the impulses can be there at most.
double largest_sum(const Batch& from, double square, const Grid& grid) {
  constexpr std::size_t kParts = std::size_t{kMostParts} * kMostParts * kMostParts;
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  HWY_ALIGN double sums[kParts * kPad];
  HWY_ALIGN double squares[3][kMostParts * kPad];
  const double* const coordinates[3] = {from.x, from.y, from.z};
  const int parts = grid.count[0] * grid.count[1] * grid.count[2];
  const auto zero = hn::Zero(d), top = hn::Set(d, kTop), s = hn::Set(d, square);
  for (int n = 0; n < parts; ++n) hn::Store(zero, d, sums + n * kPad);
  for (std::size_t i = 0; i < from.count; i += lanes) {
    const auto weight = hn::LoadU(d, from.weight + i);
    for (int axis = 0; axis < 3; ++axis) {
      const auto place = hn::LoadU(d, coordinates[axis] + i), half = hn::Set(d, grid.half[axis]);
      for (int n = 0; n < grid.count[axis]; ++n) {
        const auto away = hn::Abs(hn::Sub(place, hn::Set(d, grid.offset[axis][n])));
        const auto low = hn::Max(zero, hn::Sub(away, half));
        hn::Store(hn::Mul(s, hn::Mul(low, low)), d, squares[axis] + n * kPad);
      }
    }
    double* sum = sums;
    for (int x = 0; x < grid.count[0]; ++x) {
      const auto after_x = hn::Sub(top, hn::Load(d, squares[0] + x * kPad));
      for (int y = 0; y < grid.count[1]; ++y) {
        const auto after_y = hn::Sub(after_x, hn::Load(d, squares[1] + y * kPad));
        for (int z = 0; z < grid.count[2]; ++z, sum += kPad) {
          const auto q = hn::Max(zero, hn::Sub(after_y, hn::Load(d, squares[2] + z * kPad)));
          const auto term = hn::Mul(hn::Mul(q, q), hn::Mul(q, weight));
          hn::Store(hn::Add(hn::Load(d, sum), term), d, sum);
        }
      }
    }
  }
  double largest = 0.0;
  for (int n = 0; n < parts; ++n) {
    const double whole = sum_of(hn::Load(d, sums + n * kPad));
    if (whole > largest) largest = whole;
  }
  return largest * (1.0 + 1e-12);
}

}  // namespace morsel::geom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <cmath>
#include <vector>

namespace morsel::geom {
namespace {

HWY_EXPORT(gather);
HWY_EXPORT(choose);
HWY_EXPORT(largest_sum);

// In parts of the kernel's radius: of the parts of a box that sums are made for, and the widest box
// that is divided into those at once.
constexpr double kPart = 0.5, kWidest = kMostParts * kPart * 1.0001;

// Room for a number of impulses, and for what is written behind the last one.
class Room {
 public:
  explicit Room(std::size_t count)
      : stride_(count + kPad), numbers_(std::make_unique_for_overwrite<double[]>(4 * stride_)) {}
  Batch batch() const {
    double* p = numbers_.get();
    return {p, p + stride_, p + 2 * stride_, p + 3 * stride_, 0};
  }

 private:
  std::size_t stride_;
  std::unique_ptr<double[]> numbers_;
};

// Over the part of the box of half sizes `half` about `offset` from the centre.
double largest_over(const Batch& from, double square, const double (&offset)[3],
                    const double (&half)[3]) {
  if (from.count == 0) return 0.0;
  const double frequency = std::sqrt(square);
  Grid grid;
  int halves[3];
  bool any_wide = false;
  for (int axis = 0; axis < 3; ++axis) {
    const double width = 2.0 * half[axis] * frequency;
    halves[axis] = width > kWidest ? 2 : 1;
    any_wide = any_wide || halves[axis] == 2;
    const int count = std::clamp(static_cast<int>(std::ceil(width / kPart - 1e-3)), 1, kMostParts);
    grid.count[axis] = count;
    // A little wider, so that rounding leaves no gap.
    grid.half[axis] = half[axis] / count * (1.0 + 1e-12);
    for (int n = 0; n < count; ++n)
      grid.offset[axis][n] = offset[axis] + half[axis] * ((2 * n + 1.0) / count - 1.0);
  }
  if (!any_wide) return HWY_DYNAMIC_DISPATCH(largest_sum)(from, square, grid);
  double largest = 0.0, part[3], middle[3];
  for (int axis = 0; axis < 3; ++axis) part[axis] = half[axis] / halves[axis] * (1.0 + 1e-12);
  const Room room(from.count);
  for (int n = 0; n < 8; ++n) {
    bool there = true;
    for (int axis = 0; axis < 3; ++axis) {
      const int side = n >> axis & 1;
      there = there && side < halves[axis];
      middle[axis] =
          halves[axis] == 1 ? offset[axis] : offset[axis] + (side == 0 ? -0.5 : 0.5) * half[axis];
    }
    if (!there) continue;
    Batch near = room.batch();
    HWY_DYNAMIC_DISPATCH(choose)(from, square, middle, part, near);
    largest = std::max(largest, largest_over(near, square, middle, part));
  }
  return largest;
}

}  // namespace

ImpulseRange& ImpulseRange::operator+=(const ImpulseRange& other) {
  lo += other.lo;
  hi += other.hi;
  for (int i = 0; i < 3; ++i) gradient[i] += other.gradient[i];
  hessian += other.hessian;
  return *this;
}

ImpulseRange range_of(const ImpulseList& impulses, const Imath::V3d& centre,
                      const Imath::V3d& half) {
  ImpulseRange range;
  if (impulses.empty()) return range;
  const std::size_t most = impulses.block_count() * ImpulseBlock::kSize;
  const Room positive(most), negative(most);
  Gathered near{positive.batch(), negative.batch(), {}, 0.0};
  HWY_DYNAMIC_DISPATCH(gather)
  (impulses.blocks(), impulses.block_count(), &centre.x, &half.x, near);
  const double s = impulses.inverse_square(0);
  const double extent[3] = {half.x, half.y, half.z};
  range.hi = largest_over(near.positive, s, {0.0, 0.0, 0.0}, extent);
  range.lo = -largest_over(near.negative, s, {0.0, 0.0, 0.0}, extent);
  for (int i = 0; i < 3; ++i) range.gradient[i] = near.gradient[i] * (1.0 + 1e-9);
  // d2K/dx_i^2 = 24 s^2 d_i^2 q - 6 s q^2 with s d_i^2 <= 1 - q is within [-6 s, 4.8 s]; mixed ones
  // are at most 12 s q (1 - q).
  range.hessian = 6.0 * (1.0 + 1e-9) * s * near.weights;
  return range;
}

}  // namespace morsel::geom
#endif

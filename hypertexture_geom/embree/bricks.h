// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "hypertexture_geom/embree/segment.h"
#include "hypertexture_geom/field/compiled_field.h"
#include "topology/box.h"
#include "topology/certified.h"
#include "topology/local_model.h"
#include "topology/octree.h"
#include "topology/scalar_field.h"

namespace morsel::geom {

// A range of real numbers in 4 bytes: two floats of which only the upper halves are kept, rounded
// outward (8 bits of precision, the exponent range of float).
class CoarseRange {
 public:
  CoarseRange() = default;
  explicit CoarseRange(topology::Interval r) : lo_(below(r.lo)), hi_(above(r.hi)) {}
  double lo() const { return widen(lo_); }
  double hi() const { return widen(hi_); }

 private:
  static float widen(std::uint16_t bits) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(bits) << 16);
  }
  // The largest representable number <= x. An unbounded range is held as the largest finite one,
  // which keeps 0 * infinity out of the ray's slopes and excludes nothing at any scale that occurs.
  static std::uint16_t below(double x) {
    constexpr double kLargest = 1e30;
    if (!(x > -kLargest)) x = -kLargest;
    if (x > kLargest) x = kLargest;
    auto bits =
        static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(static_cast<float>(x)) >> 16);
    while (static_cast<double>(widen(bits)) > x) {
      if (bits == 0)
        bits = 0x8001;  // just below zero
      else if (bits & 0x8000u)
        ++bits;
      else
        --bits;
    }
    return bits;
  }
  static std::uint16_t above(double x) { return static_cast<std::uint16_t>(below(-x) ^ 0x8000u); }

  std::uint16_t lo_ = 0, hi_ = 0;
};

// A box that holds surface of a kept component: an octree cell, or a part of a leaf. 128 bytes, two
// cache lines. Its cubic is in coordinates u that span [-1, 1] over the box along each axis.
struct alignas(64) Brick {
  float c[topology::monomial::kCount];  // the cubic P, in the order of topology::monomial
  // Bounds on the brick and its slack, rounding of restrict_to_ray included:
  float value_error;         // |F - P|
  float gradient_error;      // |dF/du_i - dP/du_i|, every i
  float hessian_error;       // |d2F/du_i du_j - d2P/du_i du_j|, every i, j
  float rounding;            // the part of value_error that is rounding of float
  std::uint32_t cell[3];     // its place among the 2^depth cells of that level, along each axis
  std::uint32_t depth : 5;   // level in the octree
  std::uint32_t block : 27;  // index of the restricted field that it shares
  std::uint32_t component;   // id in the table of components
  // Along each axis the slices, of kSlices that the box is cut into, that may hold surface: from
  // surface_lo to before surface_hi.
  std::uint8_t surface_lo[3], surface_hi[3];
  bool undecided;  // the leaf's content is not proved: its surface may be of several components
  std::uint8_t reserved[5];  // 0: as files have it, without padding
  static constexpr int kSlices = 16;
};
static_assert(sizeof(Brick) == 128);

// What the segment solver knows of a brick instead: ranges of the derivatives on it.
struct SlopeRanges {
  CoarseRange gradient[3];  // dF/dx_i
  CoarseRange hessian[6];   // xx, yy, zz, xy, xz, yz
};
static_assert(sizeof(SlopeRanges) == 36);

// The bricks of all kept components with the fields that evaluate them. Every surface point of a
// kept component lies in a brick, and no brick holds surface of another component than its own, but
// for those of undecided leaves. A
// block is an octree cell of at most `block_levels` levels above its leaves; its field is the
// geometry's field restricted to the block's box and a margin, so that evaluation meets few terms.
class BrickSet {
 public:
  struct Options {
    int block_levels = 4;
    // Kept around every block: points within it of a brick may be evaluated by `field`.
    double margin = 0.0;
    // Bricks are the leaves, whatever their models' errors, and know their ranges of slopes.
    bool slope_ranges = false;
    // Else a brick is the largest cell, up to merge_levels above a leaf, whose model's error is
    // below this share of the change of F across half of it; leaves are halved, up to split_levels
    // times, while it is not.
    double error_ratio = 0.04;
    int merge_levels = 2;
    int split_levels = 1;
  };

  // `kept[id]` for every component of the octree. Runs in the caller's TBB arena; the result does
  // not depend on the number of threads. Throws std::length_error beyond 2^27 blocks, Cancelled.
  BrickSet(const topology::ScalarField& field, const topology::OctreeView& octree,
           const std::vector<bool>& kept, const Options& options,
           const topology::Execution& execution = {});

  std::uint32_t size() const { return static_cast<std::uint32_t>(bricks_.size()); }
  const Brick& operator[](std::uint32_t i) const { return bricks_[i]; }
  std::size_t block_count() const { return blocks_.size(); }
  // The blocks' fields included.
  std::size_t bytes() const;

  // The brick's cell, exactly as the octree has it.
  topology::Box box(const Brick& b) const {
    const Imath::V3d& cell = sizes_[b.depth];
    topology::Box r;
    for (int i = 0; i < 3; ++i) {
      r.min[i] = root_.min[i] + b.cell[i] * cell[i];
      r.max[i] = root_.min[i] + (b.cell[i] + 1.0) * cell[i];
    }
    return r;
  }
  Imath::V3d lower_corner(const Brick& b) const {
    const Imath::V3d& cell = sizes_[b.depth];
    return {root_.min.x + b.cell[0] * cell.x, root_.min.y + b.cell[1] * cell.y,
            root_.min.z + b.cell[2] * cell.z};
  }
  // Coordinates of a brick of this level, in which it spans [-1, 1], per length.
  const Imath::V3d& scale(std::uint32_t depth) const { return scales_[depth]; }
  // The part of it that may hold surface.
  topology::Box surface_box(const Brick& b) const {
    const Imath::V3d& cell = sizes_[b.depth];
    constexpr double kSlice = 1.0 / Brick::kSlices;
    topology::Box r;
    for (int i = 0; i < 3; ++i) {
      r.min[i] = root_.min[i] + (b.cell[i] + kSlice * b.surface_lo[i]) * cell[i];
      r.max[i] = root_.min[i] + (b.cell[i] + kSlice * b.surface_hi[i]) * cell[i];
    }
    return r;
  }
  // Edges of the cells of a level.
  const Imath::V3d& cell_size(std::uint32_t depth) const { return sizes_[depth]; }
  // How far around its box a brick answers for roots, so that none is lost on a shared face, edge
  // or corner: a ray's place is uncertain by a few ulp of its coordinates.
  double slack(const Brick& b) const { return kSlack * sizes_[b.depth].x; }
  // F on the brick's box and `margin` around it, by values and gradients (compiled_field.h).
  const CompiledField<double>& field(const Brick& b) const { return *blocks_[b.block]; }
  double margin() const { return margin_; }

  bool has_slope_ranges() const { return slope_ranges_; }
  // Bounds on the derivatives of F(o + t * direction) for points within slack of brick `i`; only
  // with slope_ranges.
  RayBounds ray_bounds(std::uint32_t i, const Imath::V3d& direction) const;

 private:
  friend class BrickBuilder;
  friend class BrickFile;
  BrickSet(const topology::Box& root, const Options& options);  // without bricks
  // The field of a block, restricted to it. No other form of it is kept: blocks are most of the
  // memory of a geometry with many octaves.
  using Block = std::unique_ptr<CompiledField<double>>;
  static constexpr double kSlack = 1e-7;

  topology::Box root_;
  Imath::V3d sizes_[32], scales_[32];  // by level
  double margin_ = 0.0;
  bool slope_ranges_ = false;
  std::vector<Brick> bricks_;
  std::vector<SlopeRanges> ranges_;  // empty without slope_ranges
  std::vector<Block> blocks_;
};

}  // namespace morsel::geom

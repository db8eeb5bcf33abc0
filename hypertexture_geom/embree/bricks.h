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
#include "topology/box.h"
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

// One leaf of the octree that holds surface of a kept component: what a ray needs to know of it.
struct Brick {
  std::uint32_t cell[3];     // its place among the 2^depth cells of that level, along each axis
  std::uint32_t depth : 5;   // level in the octree
  std::uint32_t block : 27;  // index of the restricted field that it shares
  std::uint32_t component;   // id in the table of components
  CoarseRange gradient[3];   // ranges of dF/dx_i on the inflated brick
  CoarseRange hessian[6];    // and of xx, yy, zz, xy, xz, yz
};
static_assert(sizeof(Brick) == 56);

// The bricks of all kept components with the fields that evaluate them. A block is an octree cell
// of at most `block_levels` levels above its bricks; its field is the geometry's field restricted
// to the block's box and a margin, so that evaluation meets few terms.
class BrickSet {
 public:
  struct Options {
    int block_levels = 4;
    // Kept around every block: points within it of a brick may be evaluated by `field`.
    double margin = 0.0;
  };

  // `kept[id]` for every component of the octree. Runs in the caller's TBB arena; the result does
  // not depend on the number of threads. Throws std::length_error beyond 2^27 blocks.
  BrickSet(const topology::ScalarField& field, const topology::OctreeView& octree,
           const std::vector<bool>& kept, const Options& options);

  std::uint32_t size() const { return static_cast<std::uint32_t>(bricks_.size()); }
  const Brick& operator[](std::uint32_t i) const { return bricks_[i]; }
  std::size_t block_count() const { return blocks_.size(); }
  // Without the blocks' fields, whose size only they know.
  std::size_t bytes() const {
    return bricks_.capacity() * sizeof(Brick) + blocks_.capacity() * sizeof(blocks_[0]);
  }

  // The octree leaf itself, exactly as the octree has it.
  topology::Box box(const Brick& b) const {
    const double scale = std::ldexp(1.0, -static_cast<int>(b.depth));
    const Imath::V3d cell = size_ * scale;
    topology::Box r;
    for (int i = 0; i < 3; ++i) {
      r.min[i] = root_.min[i] + b.cell[i] * cell[i];
      r.max[i] = root_.min[i] + (b.cell[i] + 1.0) * cell[i];
    }
    return r;
  }
  // How far around its box a brick answers for roots, so that none is lost on a shared face, edge
  // or corner: a ray's place is uncertain by a few ulp of its coordinates.
  double slack(const topology::Box& box) const { return kSlack * (box.max.x - box.min.x); }
  // F on the brick's box and `margin` around it.
  const topology::ScalarField& field(const Brick& b) const { return *blocks_[b.block]; }
  double margin() const { return margin_; }

  // Bounds on the derivatives of F(o + t * direction) for points within slack of the brick.
  RayBounds ray_bounds(const Brick& b, const Imath::V3d& direction) const;

 private:
  static constexpr double kSlack = 1e-7;
  struct Builder;

  topology::Box root_;
  Imath::V3d size_{0.0};
  double margin_ = 0.0;
  std::vector<Brick> bricks_;
  std::vector<std::unique_ptr<topology::ScalarField>> blocks_;
};

}  // namespace morsel::geom

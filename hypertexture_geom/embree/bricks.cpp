// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/bricks.h"

#include <algorithm>

#include "hypertexture_geom/embree/brick_builder.h"

namespace morsel::geom {

BrickSet::BrickSet(const topology::ScalarField& field, const topology::OctreeView& octree,
                   const std::vector<bool>& kept, const Options& options,
                   const topology::Execution& execution)
    : BrickSet(octree.box, options) {
  BrickBuilder(*this, octree, kept, options, execution).build(field);
}

BrickSet::BrickSet(const topology::Box& root, const Options& options)
    : root_(root), margin_(options.margin), slope_ranges_(options.slope_ranges) {
  for (int depth = 0; depth < 32; ++depth) {
    sizes_[depth] = (root_.max - root_.min) * std::ldexp(1.0, -depth);
    scales_[depth] = Imath::V3d(2.0) / sizes_[depth];
  }
}

std::size_t BrickSet::bytes() const {
  std::size_t fields = 0;
  for (const Block& b : blocks_) fields += b->bytes();
  return bricks_.capacity() * sizeof(Brick) + ranges_.capacity() * sizeof(SlopeRanges) +
         blocks_.capacity() * sizeof(Block) + fields;
}

RayBounds BrickSet::ray_bounds(std::uint32_t index, const Imath::V3d& d) const {
  const SlopeRanges& b = ranges_[index];
  RayBounds r;
  const auto add = [](double& lo, double& hi, double factor, const CoarseRange& range) {
    const double p = factor * range.lo(), q = factor * range.hi();
    lo += std::min(p, q);
    hi += std::max(p, q);
  };
  for (int i = 0; i < 3; ++i) add(r.slope_lo, r.slope_hi, d[i], b.gradient[i]);
  const double squares[6] = {d.x * d.x,       d.y * d.y,       d.z * d.z,
                             2.0 * d.x * d.y, 2.0 * d.x * d.z, 2.0 * d.y * d.z};
  for (int i = 0; i < 6; ++i) add(r.curvature_lo, r.curvature_hi, squares[i], b.hessian[i]);
  return r;
}

}  // namespace morsel::geom

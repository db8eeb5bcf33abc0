// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/embree/bricks.h"
#include "hypertexture_geom/embree/ray_surface.h"

namespace morsel::geom {

// Ray tests against bricks, by the segment solver where bricks know their ranges of slopes, else by
// the model solver.
class BrickSurface final : public RaySurface {
 public:
  // `whole` is the field that the bricks are of, for places that are in none; must outlive this.
  BrickSurface(BrickSet bricks, const topology::ScalarField& whole, double tolerance)
      : RaySurface(tolerance), bricks_(std::move(bricks)), whole_(whole) {}

  std::uint32_t size() const override { return bricks_.size(); }
  topology::Box bounds(std::uint32_t brick) const override {
    return bricks_.surface_box(bricks_[brick]);
  }
  topology::Box cell(std::uint32_t brick) const override { return bricks_.box(bricks_[brick]); }
  std::uint64_t blocks() const override { return bricks_.block_count(); }
  std::uint64_t bytes() const override { return bricks_.bytes(); }
  std::uint32_t component(std::uint32_t brick) const override { return bricks_[brick].component; }
  double value_at(std::uint32_t brick, const Imath::V3d& x) const override;
  double value_and_gradient_at(std::uint32_t brick, const Imath::V3d& x,
                               Imath::V3d& gradient) const override;

 protected:
  bool search(std::uint32_t brick, const RaySegment& ray, bool any, Root& root) const override;
  bool has_several(std::uint32_t brick) const override { return bricks_[brick].undecided; }

 private:
  // The ray's stretch within a brick.
  struct Stretch {
    double from, to;
    Imath::V3d entry;  // at `from`, so that a far origin costs no precision in F
    double speed;      // length of the direction
    bool strict;       // the ray starts there: a root at `from` is not a hit
  };
  bool by_segment(std::uint32_t brick, const RaySegment& ray, const Stretch& stretch, bool any,
                  Root& root) const;
  bool by_model(const Brick& brick, const RaySegment& ray, const Stretch& stretch, bool any,
                Root& root) const;

  // The brick's own field if it holds at `x`.
  const CompiledField<double>* field_at(std::uint32_t brick, const Imath::V3d& x) const;

  BrickSet bricks_;
  const topology::ScalarField& whole_;
};

}  // namespace morsel::geom

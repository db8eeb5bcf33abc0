// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/embree/ray_surface.h"

namespace morsel::geom {

// Sphere tracing with one Lipschitz constant for all of the object, one primitive: the method of
// Gamito & Maddock's paper, after Hart, "Sphere tracing" (1996). The reference that faster solvers
// are compared with. It knows no component, so every root is put to the membership filter.
class SphereSurface final : public RaySurface {
 public:
  // |grad F| <= lipschitz on the box, which holds all kept surface; empty: nothing is kept. The
  // field must outlive this object.
  SphereSurface(const topology::ScalarField& field, const topology::Box& box, double lipschitz,
                double tolerance)
      : RaySurface(tolerance), field_(field), box_(box), lipschitz_(lipschitz) {}

  std::uint32_t size() const override { return box_.isEmpty() ? 0 : 1; }
  std::uint64_t bytes() const override { return sizeof *this; }
  topology::Box bounds(std::uint32_t) const override { return box_; }
  std::uint32_t component(std::uint32_t) const override { return topology::kNoComponent; }
  double value_at(std::uint32_t, const Imath::V3d& x) const override { return field_.value(x); }
  double value_and_gradient_at(std::uint32_t, const Imath::V3d& x,
                               Imath::V3d& gradient) const override {
    const topology::Jet jet = field_.jet(x);
    gradient = jet.gradient;
    return jet.value;
  }

  // Steps along one ray. Steps have at least the tolerance's length, so a ray that runs along the
  // surface ends here.
  static constexpr int kMaxSteps = 1 << 16;

 protected:
  bool search(std::uint32_t primitive, const RaySegment& ray, bool any, Root& root) const override;
  bool has_several(std::uint32_t) const override { return true; }

 private:
  const topology::ScalarField& field_;
  topology::Box box_;
  double lipschitz_;
};

}  // namespace morsel::geom

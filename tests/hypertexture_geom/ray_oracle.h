// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "hypertexture_geom/field/field.h"
#include "topology/certified.h"

namespace morsel::geom::test {

// First hits by brute force, sharing nothing with the solver under test but the field and the
// octree's labels: the ray is marched in double precision through every leaf that may hold surface,
// in fixed steps far below the finest feature, and a sign change is bisected. Leaves certified to
// be empty or full are skipped.
class RayOracle {
 public:
  // `step` is a length. `field`, `topology` outlive this.
  RayOracle(const topology::ScalarField& field, const topology::Topology& topology,
            std::vector<bool> keep, double step);

  struct Crossing {
    double t;
    std::uint32_t component;
    bool kept;
  };
  // First crossing of a kept component with t > 0.
  std::optional<Crossing> first_hit(const Imath::V3d& origin, const Imath::V3d& direction) const;

  // Whether F changes its sign within `radius` (a length) of parameter t, looked for with steps a
  // thousand times finer than the march's.
  bool changes_sign_near(const Imath::V3d& origin, const Imath::V3d& direction, double t,
                         double radius) const;
  // The least |F| found that near.
  double least_value_near(const Imath::V3d& origin, const Imath::V3d& direction, double t,
                          double radius) const;

  // Component of the leaf at x, and whether it is kept.
  Crossing label(const Imath::V3d& x) const;
  double step() const { return step_; }

 private:
  // The field restricted to the leaf's ancestor that is a few levels up.
  const topology::ScalarField& field_of(std::uint32_t node) const { return *local_[owner_[node]]; }
  void restrict(std::uint32_t node, const topology::Box& box, const topology::ScalarField& field,
                int height);
  int height(std::uint32_t node);

  const topology::ScalarField& field_;
  topology::OctreeView octree_;
  std::vector<bool> keep_;
  double step_;
  std::vector<std::int8_t> heights_;  // levels down to the deepest surface leaf, -1: none
  std::vector<std::uint32_t> owner_;  // of a surface leaf: index of its field
  std::vector<std::unique_ptr<topology::ScalarField>> local_;
};

}  // namespace morsel::geom::test

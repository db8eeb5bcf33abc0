// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "topology/scalar_field.h"

namespace morsel::topology {

// F(x) + slope.(x - origin). For almost every slope, however small, this is a Morse function: its
// critical points are isolated and none is degenerate (Milnor, Morse Theory, section 6). `field`
// must outlive it and what it hands out.
class PerturbedField final : public ScalarField {
 public:
  PerturbedField(const ScalarField& field, const Imath::V3d& slope, const Imath::V3d& origin)
      : field_(&field), slope_(slope), origin_(origin) {}

  double value(const Imath::V3d& x) const override;
  Jet jet(const Imath::V3d& x) const override;
  LocalModel model(const Box& box) const override;
  std::unique_ptr<ScalarField> restricted_to(const Box& box) const override;

 private:
  PerturbedField(std::unique_ptr<ScalarField> owned, const Imath::V3d& slope,
                 const Imath::V3d& origin)
      : owned_(std::move(owned)), field_(owned_.get()), slope_(slope), origin_(origin) {}

  std::unique_ptr<ScalarField> owned_;
  const ScalarField* field_;
  Imath::V3d slope_, origin_;
};

// The perturbation of size `size` in the box: F changes by at most `size` on it. The direction is
// fixed, and parallel to no plane that scenes are likely to be symmetric in.
PerturbedField perturbed(const ScalarField& field, const Box& box, double size);

}  // namespace morsel::topology

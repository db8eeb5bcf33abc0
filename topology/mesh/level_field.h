// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>
#include <utility>

#include "topology/scalar_field.h"

namespace morsel::topology::meshing {

// F - level. `Base` is a pointer to a field, owning or not.
template <class Base>
class LevelField final : public ScalarField {
 public:
  LevelField(Base field, double level) : field_(std::move(field)), level_(level) {}

  double value(const Imath::V3d& x) const override { return field_->value(x) - level_; }
  Jet jet(const Imath::V3d& x) const override {
    Jet jet = field_->jet(x);
    jet.value -= level_;
    return jet;
  }
  LocalModel model(const Box& box) const override {
    LocalModel model = field_->model(box);
    // Rounded once; the model's own allowance is for what it computes from its coefficients.
    model.value_error += 1e-15 * (std::abs(model.c[monomial::k1]) + std::abs(level_));
    model.c[monomial::k1] -= level_;
    return model;
  }
  std::unique_ptr<ScalarField> restricted_to(const Box& box) const override {
    return std::make_unique<LevelField<std::unique_ptr<ScalarField>>>(field_->restricted_to(box),
                                                                      level_);
  }

 private:
  Base field_;
  double level_;
};

}  // namespace morsel::topology::meshing

// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/perturbed_field.h"

#include <cmath>
#include <limits>

namespace morsel::topology {

double PerturbedField::value(const Imath::V3d& x) const {
  return field_->value(x) + slope_.dot(x - origin_);
}

Jet PerturbedField::jet(const Imath::V3d& x) const {
  Jet jet = field_->jet(x);
  jet.value += slope_.dot(x - origin_);
  jet.gradient += slope_;
  return jet;
}

LocalModel PerturbedField::model(const Box& box) const {
  LocalModel m = field_->model(box);
  constexpr double kSlack = 16.0 * std::numeric_limits<double>::epsilon();
  double size = std::abs(m.c[monomial::k1]), shift = 0.0;
  for (int i = 0; i < 3; ++i) {
    double& slope = m.c[monomial::kX + i];
    m.gradient_error[i] += kSlack * (std::abs(slope) + std::abs(slope_[i]));
    slope += slope_[i];
    shift += slope_[i] * (m.centre[i] - origin_[i]);
    // The coefficient's rounding is felt in the value as well.
    size += std::abs(slope_[i]) * (std::abs(m.centre[i]) + std::abs(origin_[i]) + m.half[i]) +
            std::abs(slope) * m.half[i];
  }
  m.c[monomial::k1] += shift;
  m.value_error += kSlack * size;
  m.add_rounding();
  return m;
}

std::unique_ptr<ScalarField> PerturbedField::restricted_to(const Box& box) const {
  return std::unique_ptr<ScalarField>(
      new PerturbedField(field_->restricted_to(box), slope_, origin_));
}

PerturbedField perturbed(const ScalarField& field, const Box& box, double size) {
  const Imath::V3d direction = Imath::V3d(0.5773, 0.3141, 0.7539).normalized();
  // |slope.(x - centre)| <= |slope| half the diagonal.
  return {field, direction * (size / half_size(box).length()), centre(box)};
}

}  // namespace morsel::topology

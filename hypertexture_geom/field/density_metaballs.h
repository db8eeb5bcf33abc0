// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "hypertexture_geom/field/expression.h"

namespace morsel::geom {

// weight * (1 - |x - centre|^2 / radius^2)^3 within the radius, 0 outside.
struct Metaball {
  Imath::V3d centre;
  double radius = 1.0;
  double weight = 1.0;
};

// D(x) = sum of the balls - level: the implicit blobs of the paper's Fig. 3. Values have no unit;
// the steepest slope of one ball is 1.7174 |weight| / radius (at radius / sqrt(5)), and the
// Lipschitz constant at most the sum of these over the balls that overlap. Far from all balls D is
// the constant -level. Requires level > 0 and at least one ball.
std::unique_ptr<Expression> make_metaballs(const std::vector<Metaball>& balls, double level);

}  // namespace morsel::geom

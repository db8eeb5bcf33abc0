// SPDX-License-Identifier: Apache-2.0
#include "topology/vanishing.h"

#include <cmath>

namespace morsel::topology {

bool vanishes_along_edge(const ScalarField& field, const LocalModel& model) {
  double size = std::abs(model.c[monomial::k1]);
  for (int i = 0; i < 3; ++i)
    size += model.half[i] * std::abs(model.c[monomial::kX + static_cast<std::size_t>(i)]);
  // Most cells are undecided since the model says too little, and cost no more than this.
  constexpr double kTelling = 0x1p-8, kRounding = 0x1p-40;
  if (!(model.value_error <= kTelling * size)) return false;
  constexpr double kPlaces[] = {-1.0, -0.3819660112501051, 0.7320508075688772, 1.0};
  for (int axis = 0; axis < 3; ++axis)
    for (int corner = 0; corner < 4; ++corner) {
      Imath::V3d u;
      u[(axis + 1) % 3] = model.half[(axis + 1) % 3] * (corner & 1 ? 1.0 : -1.0);
      u[(axis + 2) % 3] = model.half[(axis + 2) % 3] * (corner & 2 ? 1.0 : -1.0);
      bool vanishes = true;
      for (const double place : kPlaces) {
        u[axis] = model.half[axis] * place;
        vanishes = std::abs(model.value_at(u)) <= 2.0 * model.value_error + kRounding * size &&
                   std::abs(field.value(model.centre + u)) <= kRounding * size;
        if (!vanishes) break;
      }
      if (vanishes) return true;
    }
  return false;
}

}  // namespace morsel::topology

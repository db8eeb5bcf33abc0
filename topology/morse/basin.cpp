// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/basin.h"

#include <algorithm>
#include <cmath>

#include "topology/morse/classify.h"

namespace morsel::topology {

double certified_basin(const ScalarField& field, const CriticalPoint& maximum, double largest) {
  if (maximum.type != CriticalType::kMaximum) return 0.0;
  const double d = std::sqrt(3.0) * maximum.radius * (1.0 + 1e-12);
  const auto concave = [&](double r) {
    const Imath::V3d half((r + d) * (1.0 + 1e-12) + 1e-300);
    return certified_type(field.model(Box(maximum.position - half, maximum.position + half))) ==
           CriticalType::kMaximum;
  };
  // From large to small: the first success is within a factor of the largest.
  for (double r = largest; r > std::max(4.0 * d, 1e-12 * largest); r *= 0.75)
    if (concave(r)) return (r - d) * (1.0 - 1e-12);
  return 0.0;
}

}  // namespace morsel::topology

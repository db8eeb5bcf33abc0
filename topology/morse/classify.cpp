// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/classify.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

namespace morsel::topology {

EigenSystem eigen_system(const double h[6]) {
  Eigen::Matrix3d m;
  m << h[0], h[3], h[4], h[3], h[1], h[5], h[4], h[5], h[2];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m);
  EigenSystem result;
  for (int i = 0; i < 3; ++i) {
    result.values[i] = solver.eigenvalues()[i];
    for (int j = 0; j < 3; ++j) result.vectors[i][j] = solver.eigenvectors()(j, i);
  }
  return result;
}

CriticalType certified_type(const LocalModel& model) {
  double middle[6], square = 0.0, size = 0.0;
  constexpr int kIndex[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (int n = 0; n < 6; ++n) {
    const Interval range = model.hessian_range(kIndex[n][0], kIndex[n][1]);
    middle[n] = range.middle();
    const double weight = n < 3 ? 1.0 : 2.0, reach = 0.5 * range.width();
    square += weight * reach * reach;
    size += weight * middle[n] * middle[n];
  }
  // The eigenvalues themselves are computed to a few units in the last place of the matrix's norm.
  const double slack = std::sqrt(square) * (1.0 + 1e-12) +
                       64.0 * std::numeric_limits<double>::epsilon() * std::sqrt(size);
  if (!std::isfinite(slack)) return CriticalType::kDegenerate;
  const Imath::V3d values = eigen_system(middle).values;
  int negative = 0;
  for (int i = 0; i < 3; ++i) {
    if (std::abs(values[i]) <= slack) return CriticalType::kDegenerate;
    negative += values[i] < 0.0;
  }
  return static_cast<CriticalType>(3 - negative);
}

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "topology/local_model.h"
#include "topology/morse/critical_point.h"
#include "topology/scalar_field.h"

namespace morsel::topology {

// Eigenvalues (ascending) and unit eigenvectors (vectors[i] belongs to values[i]) of a symmetric
// matrix xx, yy, zz, xy, xz, yz.
struct EigenSystem {
  Imath::V3d values{0.0};
  std::array<Imath::V3d, 3> vectors;
};
EigenSystem eigen_system(const double hessian[6]);

// The type that holds for every Hessian in the model's box: an eigenvalue moves by no more than the
// Frobenius norm of a symmetric perturbation (Weyl), so signs are certain where eigenvalues of the
// middle matrix are farther from 0 than that; kDegenerate otherwise.
CriticalType certified_type(const LocalModel& model);

}  // namespace morsel::topology

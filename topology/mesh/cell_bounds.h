// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <array>

#include "topology/box.h"
#include "topology/local_model.h"

namespace morsel::topology::meshing {

// What is proved of F on a cell and `reach` around it: enough to bound how far a triangle in the
// cell may be from F = 0.
struct CellBounds {
  double reach = 0.0;
  // Lower bound of the derivative of F along a fixed direction (grad F at the centre, normalised).
  // Positive: the surface in the cell is a graph over the plane across that direction.
  double slope = 0.0;
  // The Hessian at the centre, xx, yy, zz, xy, xz, yz, and a bound on the spectral norm of its
  // change from there.
  std::array<double, 6> hessian{};
  double hessian_change = 0.0;
  // An estimate, no bound: the curvature of the surface, 1 / length.
  double curvature = 0.0;
  bool resolved = false;  // see is_resolved

  // Whether the topology of the surface in the cell is proved.
  bool is_proved() const { return resolved && slope > 0.0; }

  // Bound on the distance from F = 0 of any point of the triangle, whose corners lie in the cell
  // and have |F| <= residual; infinite when nothing follows.
  double triangle_error(const std::array<Imath::V3d, 3>& corners, double residual) const;
};

// `model` holds on a box that extends `reach` beyond the cell `box`.
CellBounds bounds_of(const LocalModel& model, const Box& box, double reach);

// Whether in the box, in each of its faces and along each of its edges F keeps its sign or has a
// partial derivative that keeps its sign. Then S and its complement meet each of them in a
// contractible set or not at all, and the signs at the corners say which.
bool is_resolved(const LocalModel& model);

// Whether F is proved to lie outside of [-below, 0] everywhere in the box.
bool avoids_zero(const LocalModel& model, double below);

}  // namespace morsel::topology::meshing

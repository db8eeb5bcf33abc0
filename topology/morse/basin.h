// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "topology/morse/critical_point.h"
#include "topology/scalar_field.h"

namespace morsel::topology {

// The radius of a ball about the computed position of a maximum from which every ascent ends at
// that maximum; 0 when none is certified. `largest` bounds the search.
//
// Proof. Let the Hessian be negative definite on the box |x - p|_max <= r + d, p the computed
// position and d >= |p - m| for the true maximum m. F is then strictly concave on the ball
// |x - m| <= r, whose points lie in that box. For x in the ball, x != m:
//   d/dt |x(t) - m|^2 = 2 (x - m).grad F(x) = 2 (x - m).(grad F(x) - grad F(m)) < 0
// along x' = grad F(x): the distance to m only falls, so x(t) stays in the ball, and its limit is a
// zero of the gradient there, of which there is only m. The ball |x - p| <= r - d lies within
// |x - m| <= r; r - d is what is returned.
double certified_basin(const ScalarField& field, const CriticalPoint& maximum, double largest);

}  // namespace morsel::topology

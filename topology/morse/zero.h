// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "topology/morse/critical_point.h"
#include "topology/morse/krawczyk.h"
#include "topology/scalar_field.h"

namespace morsel::topology {

// A zero of grad F whose existence is proved, with a box that holds no other.
struct CertifiedZero {
  CriticalPoint point;
  Box unique;     // exactly one zero in here
  Box enclosure;  // it lies in here; within `unique`
};

// The Krawczyk operator on `box` with grad F enclosed at its very centre (two models).
Krawczyk krawczyk_on(const ScalarField& field, const Box& box);

// Given a box with exactly one zero, and a field that need be known in that box only: Newton's
// iteration (equation 10 of Gamito & Maddock) from the middle of `start`, then the smallest
// enclosure about its end that the Krawczyk operator proves; where Newton leaves, the operator
// itself contracts `start`. The point is classified over the enclosure; `point.set` and
// `point.basin` are left alone. `models` is increased by the models evaluated.
CertifiedZero refine_zero(const ScalarField& field, const Box& unique, const Box& start,
                          std::uint64_t& models);

// Newton's iteration for grad F = 0 within `bounds`, to 1e-12 of its size or to rounding. Empty
// when an iterate leaves the box or nothing converges in `steps` steps.
std::optional<Imath::V3d> newton(const ScalarField& field, Imath::V3d x, const Box& bounds,
                                 int steps);

// Three-valued sign of F on the enclosure of a zero.
enum class Sign { kNegative, kPositive, kUncertain };
Sign sign_on(const ScalarField& field, const Box& box);

}  // namespace morsel::topology

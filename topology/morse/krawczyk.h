// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "topology/box.h"
#include "topology/interval.h"
#include "topology/local_model.h"

namespace morsel::topology {

using IntervalVector = std::array<Interval, 3>;

// Enclosure of grad F at the centre of the model's box, from the model itself.
IntervalVector gradient_at_centre(const LocalModel& model);

// True when grad F is proved to vanish nowhere on the model's box X: the interval slope form
// Y grad F(m) + Y S (X - m), m the centre, S an enclosure of the Hessian's mean along segments from
// m and Y about the inverse of the Hessian at m, has a component without 0. Sharper than testing
// the three derivatives one by one where the Hessian turns the axes.
bool excludes_zero(const LocalModel& model);

enum class ZeroCount { kNone, kOne, kUnknown };

// What the Krawczyk operator K = m - Y g + (1 - Y H)(X - m) proves of the zeros of grad F in the
// model's box X = centre +- half; g encloses grad F at the centre. K within the interior of X:
// exactly one zero, and it lies in K; K and X disjoint: none. (R. Krawczyk, Computing 4, 1969; R.
// E. Moore, SIAM J. Numer. Anal. 14, 1977.)
struct Krawczyk {
  ZeroCount zeros = ZeroCount::kUnknown;
  Box enclosure;  // kOne: holds the zero; kUnknown: holds every zero in X
};
Krawczyk krawczyk(const LocalModel& model, const IntervalVector& g);

}  // namespace morsel::topology

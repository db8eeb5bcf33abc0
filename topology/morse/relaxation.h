// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "topology/morse/zero.h"

namespace morsel::topology {

// Critical points from seeds, after the idea of S.-T. Wu & M. de Gomensoro Malheiros ("On improving
// the search for critical points of implicit functions", Implicit Surfaces '99) for sums of radial
// functions: each seed takes a few relaxation steps towards a zero of the gradient, then Newton's
// iteration, and what it ends at is proved by the Krawczyk operator in the largest box that allows
// it. Returns those with F > 0 in the box, each once; `models` is increased by the models
// evaluated. The subdivision need not look into their boxes again.
std::vector<CertifiedZero> relax_seeds(const ScalarField& field, const Box& box,
                                       const std::vector<Imath::V3d>& seeds, std::uint64_t& models);

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "topology/certified.h"
#include "topology/scalar_field.h"

namespace morsel::topology {

// 1 where F >= 0 at the corners of one layer of an n^3 grid of the box: [j * (n + 1) + i].
using SignLayer = std::span<const std::uint8_t>;

// Samples the sign of F at the (n + 1)^3 corners of a grid, layer by layer along z, and calls
// visit(k, below, above) for k = 0 ... n - 1 with layers k and k + 1. Blocks of samples are
// evaluated in parallel; a block on which a local model proves one sign is not evaluated. Returns
// the number of evaluations. Throws Cancelled.
std::uint64_t for_each_sign_slab(const ScalarField& field, const Box& box, int n,
                                 const Execution& execution,
                                 const std::function<void(int, SignLayer, SignLayer)>& visit);

}  // namespace morsel::topology

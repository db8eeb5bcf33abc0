// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>

namespace morsel::geom {

// One impulse of a sparse convolution noise: position within its lattice cell in [0, 1)^3, weight
// in [-1, 1).
struct CellImpulse {
  double x, y, z, weight;
};

// Impulse `index` of lattice cell (i, j, k). Hashed with 32-bit integers only, and every result is
// a multiple of 2^-32 (2^-31 for the weight), so that all machines get the same numbers. Different
// seeds and different octaves give independent processes. Cells repeat after 2^32.
CellImpulse cell_impulse(std::int64_t i, std::int64_t j, std::int64_t k, std::uint32_t index,
                         std::uint32_t octave, std::uint32_t seed);

// The same in two steps, for all impulses of a cell: what they have in common, and one of them.
std::uint32_t impulse_cell_key(std::uint32_t process_key, std::int64_t i, std::int64_t j,
                               std::int64_t k);
CellImpulse cell_impulse(std::uint32_t cell_key, std::uint32_t index);

// The state that hashing a cell starts from.
std::uint32_t impulse_process_key(std::uint32_t octave, std::uint32_t seed);

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace morsel::geom {

// A 32-bit finalizer: xor-shifts and odd multipliers, a bijection (constants: C. Wellons,
// "hash-prospector", lowest bias found of this form). Integers only: the same on every machine.
inline std::uint32_t scramble(std::uint32_t h) {
  h ^= h >> 16;
  h *= 0x21f0aaadu;
  h ^= h >> 15;
  h *= 0x735a2d97u;
  h ^= h >> 15;
  return h;
}

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/impulse_process.h"

#include "hypertexture_geom/field/integer_hash.h"

namespace morsel::geom {

std::uint32_t impulse_process_key(std::uint32_t octave, std::uint32_t seed) {
  return scramble(scramble(seed ^ 0x9e3779b9u) ^ octave);
}

// Each word is mixed in after a full scramble of those before it, so that no two of them can
// cancel.
std::uint32_t impulse_cell_key(std::uint32_t process_key, std::int64_t i, std::int64_t j,
                               std::int64_t k) {
  std::uint32_t h = scramble(process_key + static_cast<std::uint32_t>(i));
  h = scramble(h ^ static_cast<std::uint32_t>(j) * 0x85ebca6bu);
  return scramble(h + static_cast<std::uint32_t>(k) * 0xc2b2ae35u);
}

CellImpulse cell_impulse(std::uint32_t cell_key, std::uint32_t index) {
  const std::uint32_t h = scramble(cell_key ^ index);
  const std::uint32_t hx = scramble(h + 0x68bc21ebu);
  const std::uint32_t hy = scramble(h + 0x02e5be93u);
  const std::uint32_t hz = scramble(h + 0x967a889bu);
  const std::uint32_t hw = scramble(h + 0xb5297a4du);
  return {hx * 0x1p-32, hy * 0x1p-32, hz * 0x1p-32, hw * 0x1p-31 - 1.0};
}

CellImpulse cell_impulse(std::int64_t i, std::int64_t j, std::int64_t k, std::uint32_t index,
                         std::uint32_t octave, std::uint32_t seed) {
  return cell_impulse(impulse_cell_key(impulse_process_key(octave, seed), i, j, k), index);
}

}  // namespace morsel::geom

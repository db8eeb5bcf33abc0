// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/perlin_lattice.h"

#include "hypertexture_geom/field/integer_hash.h"

namespace morsel::geom {

PerlinLattice::PerlinLattice(std::uint32_t octave, std::uint32_t seed)
    : key_(scramble(scramble(seed ^ 0x3c6ef372u) ^ octave)) {
  const auto fraction = [this](std::uint32_t salt) {
    return (scramble(key_ ^ salt) >> 16) * 0x1p-16;
  };
  offset_ = Imath::V3d(fraction(0xa54ff53au), fraction(0x510e527fu), fraction(0x9b05688cu));
}

int PerlinLattice::direction(std::int64_t i, std::int64_t j, std::int64_t k) const {
  // Each word is mixed in after a full scramble of those before it, so that no two of them can
  // cancel.
  std::uint32_t h = scramble(key_ + static_cast<std::uint32_t>(i));
  h = scramble(h ^ static_cast<std::uint32_t>(j) * 0x85ebca6bu);
  h = scramble(h + static_cast<std::uint32_t>(k) * 0xc2b2ae35u);
  // The upper digit in base 12 of the fraction h / 2^32: uniform to within 2^-29.
  return static_cast<int>((static_cast<std::uint64_t>(h) * kPerlinDirections) >> 32);
}

}  // namespace morsel::geom

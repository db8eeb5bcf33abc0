// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>

namespace morsel::geom {

// Directions from the centre of a cube to the midpoints of its 12 edges: the gradients of Perlin's
// improved noise.
inline constexpr int kPerlinDirections = 12;
inline constexpr double kPerlinDirection[kPerlinDirections][3] = {
    {1, 1, 0},  {-1, 1, 0},  {1, -1, 0}, {-1, -1, 0}, {1, 0, 1},  {-1, 0, 1},
    {1, 0, -1}, {-1, 0, -1}, {0, 1, 1},  {0, -1, 1},  {0, 1, -1}, {0, -1, -1}};

// One octave's integer lattice: which of the 12 directions each of its points has, and where the
// lattice lies. Hashed with 32-bit integers only, hence the same on every machine; different seeds
// and octaves are independent. Repeats after 2^32 cells.
//
// The reference implementation permutes 256 entries instead (period 256, one fixed lattice) and
// takes the direction from 4 bits of that, which gives 4 of the 12 directions double weight; here
// all are equally likely. Lattice values therefore differ from the reference's, in distribution
// only by that.
class PerlinLattice {
 public:
  PerlinLattice(std::uint32_t octave, std::uint32_t seed);

  // Index into kPerlinDirection of the gradient at lattice point (i, j, k).
  int direction(std::int64_t i, std::int64_t j, std::int64_t k) const;

  // Added to frequency * x to get lattice coordinates, so that octaves have no zero in common.
  // Multiples of 2^-16 in [0, 1): exact wherever frequency * x is and has bits to spare.
  const Imath::V3d& offset() const { return offset_; }

  // The state that hashing a lattice point starts from.
  std::uint32_t key() const { return key_; }

 private:
  std::uint32_t key_;
  Imath::V3d offset_;
};

}  // namespace morsel::geom

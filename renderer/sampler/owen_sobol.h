// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// Building blocks of an Owen-scrambled two-dimensional Sobol sequence. Values are 32-bit
// fractions of 1; several functions work on fractions whose bits are reversed (bit 0 = one half),
// because that is the form that a hash can scramble cheaply.
namespace morsel::render {

inline std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  return __builtin_bswap32(x);
}

// Owen scrambling of bit-reversed fractions: whether a bit flips depends on the seed and on lower
// bits only. The form is Laine & Karras's (EGSR 2011); the constants and the multiplication by
// the seed, which remove its visible defects, are N. Vegdahl's ("Building a Better LK Hash", 2021).
inline std::uint32_t owen_hash(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// The same with a result whose bits are in normal order. Applied to (reversed) sample indices it
// permutes every aligned block of 2^k indices onto an aligned block, so nets stay nets.
inline std::uint32_t owen_shuffle(std::uint32_t reversed_index, std::uint32_t seed) {
  return reverse_bits(owen_hash(reversed_index, seed));
}

// Second dimension of the Sobol sequence at `index`, bits reversed. Its generator matrix is
// Pascal's triangle modulo 2, and by Lucas's theorem bit i of the reversed result is the parity of
// the index bits j whose position contains i as a subset of binary digits; that is a sum over
// supersets, done here one digit of the positions at a time. (The first dimension, bits reversed,
// is the index itself.)
inline std::uint32_t sobol_second_reversed(std::uint32_t index) {
  index ^= (index & 0xaaaaaaaau) >> 1;
  index ^= (index & 0xccccccccu) >> 2;
  index ^= (index & 0xf0f0f0f0u) >> 4;
  index ^= (index & 0xff00ff00u) >> 8;
  index ^= (index & 0xffff0000u) >> 16;
  return index;
}

// A bijective finaliser with full avalanche (the constants of T. Mueller's 2-round
// xorshift-multiply search, "lowbias32" by C. Wellons).
constexpr std::uint32_t mix_bits(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}
// The second argument is mix_bits(b).
constexpr std::uint32_t combine_mixed(std::uint32_t a, std::uint32_t mixed_b) {
  return mix_bits(a ^ (mixed_b + 0x9e3779b9u + (a << 6) + (a >> 2)));
}
constexpr std::uint32_t combine_bits(std::uint32_t a, std::uint32_t b) {
  return combine_mixed(a, mix_bits(b));
}

// Fraction to [0, 1), 24 bits: the largest result is below 1.
inline float to_unit_float(std::uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; }

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "renderer/math/vector.h"

// Sums in fixed point. Integer addition is associative, so what a pixel adds up to depends neither
// on the order of its samples nor on how they are spread over runs and machines: a render that was
// interrupted, or put together from shards, has the same bits as one that was not.
namespace morsel::render {

// NOLINTNEXTLINE(modernize-use-using): -Wpedantic lets a typedef pass alone.
__extension__ typedef __int128 Int128;

// x in steps of 2^-64, rounded towards 0; |x| < 2^63. By its bits, for conversions to 128 bits are
// calls.
inline Int128 in_steps(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  const std::uint64_t digits = (bits & 0xfffffffffffffu) | 0x10000000000000u;  // 53
  const int exponent = static_cast<int>(bits >> 52 & 0x7ffu) - (1023 + 52);    // of the last digit
  const int shift = exponent + 64;
  if (shift <= -53) return 0;
  const Int128 steps = shift >= 0 ? Int128{digits} << shift : Int128{digits >> -shift};
  return x < 0.0 ? -steps : steps;
}

// The most samples that a scene may ask for; sums of twice that do not overflow.
inline constexpr std::uint32_t kMostSamples = 1u << 20;

// A colour, of which samples are added: steps of 2^-64, each sample clamped to +-2^40, so that 2^20
// samples (the most that a scene may ask for) and more cannot overflow.
struct ColorSum {
  Int128 channel[3] = {0, 0, 0};

  // Finite values only.
  void add(const V3f& c) {
    for (int i = 0; i < 3; ++i) channel[i] += in_steps(std::clamp(double{c[i]}, -kMost, kMost));
  }
  void add(const ColorSum& other) {
    for (int i = 0; i < 3; ++i) channel[i] += other.channel[i];
  }
  // Whether so many samples can have this sum.
  bool is_sum_of(std::uint32_t samples) const {
    const Int128 most = samples * (Int128{1} << 104);
    return std::all_of(channel, channel + 3, [&](Int128 c) { return c >= -most && c <= most; });
  }
  double value(int i) const { return static_cast<double>(channel[i]) * 0x1p-64; }
  V3d mean(double count) const { return {value(0) / count, value(1) / count, value(2) / count}; }

  static constexpr double kMost = 0x1p40;
};

// Squares of a colour's channels, in the same steps. The sum stops at 2^61, which is to say that
// the variance of a pixel with samples beyond 10^9 is only bounded from below.
struct SquareSum {
  Int128 channel[3] = {0, 0, 0};

  void add(const V3f& c) {
    for (int i = 0; i < 3; ++i) raise(channel[i], in_steps(std::min(double{c[i]} * c[i], 0x1p61)));
  }
  void add(const SquareSum& other) {
    for (int i = 0; i < 3; ++i) raise(channel[i], other.channel[i]);
  }
  bool is_sum_of_squares() const {
    return std::all_of(channel, channel + 3, [&](Int128 c) { return c >= 0 && c <= kMost; });
  }
  bool saturated(int i) const { return channel[i] >= kMost; }
  double value(int i) const { return static_cast<double>(channel[i]) * 0x1p-64; }

 private:
  static constexpr Int128 kMost = Int128{1} << 125;
  static void raise(Int128& sum, Int128 by) { sum = std::min(sum + std::min(by, kMost), kMost); }
};

// Numbers of magnitude below 2^9: steps of 2^-32.
struct SmallSum {
  std::int64_t total = 0;

  void add(float x) { total += static_cast<std::int64_t>(double{x} * 0x1p32); }
  void add(const SmallSum& other) { total += other.total; }
  bool is_sum_of(std::uint32_t samples) const {
    const std::int64_t most = samples * (std::int64_t{1} << 41);
    return total >= -most && total <= most;
  }
  float mean(double count) const {
    return static_cast<float>(static_cast<double>(total) * 0x1p-32 / count);
  }
};

}  // namespace morsel::render

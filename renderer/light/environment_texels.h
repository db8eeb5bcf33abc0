// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "renderer/math/huge_pages.h"
#include "renderer/math/vector.h"

namespace morsel::render {

struct EnvironmentImage;

// The texels of a lat-long image as interpolation asks for them: a patch lies between the centres
// of four texels, row r of patches between rows r - 1 and r of texels (its first and last between a
// row and the pole, with the row twice). Four patches of a row make a block, with all of their
// texels in 64 bytes, so that looking one up or choosing among the four reads a single line of the
// processor's cache: waiting for memory is most of what an environment costs.
//
// Numbers are halves times a power of two that a block has in common, so texels of an image of
// halves are exact, and others to 2^-11 of their value down to 2^-28 of the block's brightest;
// darker ones are 0.
class EnvironmentTexels {
 public:
  static constexpr int kPatches = 4;         // of a block
  static constexpr int kRow = kPatches + 1;  // texels of a row of a block
  static constexpr int kTexels = 2 * kRow;   // of a block
  // Four numbers in a register, by an extension that g++ and clang share. Of the texels about a
  // patch: upper left and right, lower left and right.
  using Floats = float __attribute__((vector_size(16)));

  // The four texels about a patch, a channel in each.
  struct Corners {
    Floats channel[3];

    V3f texel(int i) const { return {channel[0][i], channel[1][i], channel[2][i]}; }
    Floats weighed(const V3f& weight) const {
      return channel[0] * weight.x + channel[1] * weight.y + channel[2] * weight.z;
    }
    // Between them, [0, 1]^2.
    V3f at(const V2f& p) const {
      const Floats share = shares(p);
      return {sum(channel[0] * share), sum(channel[1] * share), sum(channel[2] * share)};
    }
  };
  // A number of each of a block's texels: of the upper left, upper right, lower left and lower
  // right ones of its four patches.
  struct Weighed {
    Floats upper_left, upper_right, lower_left, lower_right;
  };
  // Bilinear interpolation between four numbers.
  static float at(const Floats& corners, const V2f& p) { return sum(corners * shares(p)); }

  // `image` has as many texels as it says, finite and >= 0.
  explicit EnvironmentTexels(const EnvironmentImage& image);

  int width() const { return width_; }
  int height() const { return height_; }
  int blocks() const { return blocks_; }  // of a row; the last may have fewer patches

  void prefetch(int row, int block) const { __builtin_prefetch(&packed_[index(row, block)]); }
  // dot(texel, weight) - less, but at least 0, of each of a block's texels. row: 0 .. height.
  Weighed weigh(int row, int block, const V3f& weight, float less) const {
    const Packed& from = packed_[index(row, block)];
    const float scale = from.scale();
    const std::uint16_t *r = from.half.data(), *g = r + kTexels, *b = g + kTexels;
    const auto four = [&](int i) {
      const Floats weighed = from_halves(r + i) * scale * weight.x +
                             from_halves(g + i) * scale * weight.y +
                             from_halves(b + i) * scale * weight.z - less;
      return weighed > Floats{} ? weighed : Floats{};
    };
    const Floats first = four(0), middle = four(4), last = four(kTexels - 4);
    return {first, __builtin_shufflevector(first, middle, 1, 2, 3, 4),
            __builtin_shufflevector(middle, last, 1, 2, 3, 6), last};
  }
  // column: 0 .. width - 1.
  Corners corners(int row, int column) const {
    return corners(row, column / kPatches, column % kPatches);
  }
  Corners corners(int row, int block, int patch) const {
    const Packed& from = packed_[index(row, block)];
    const float scale = from.scale();
    Corners c;
    for (int i = 0; i < 3; ++i) {
      std::uint16_t half[4];
      const int first = i * kTexels + patch;
      const std::uint16_t* upper = &from.half[static_cast<std::size_t>(first)];
      std::memcpy(half, upper, 2 * sizeof *half);
      std::memcpy(half + 2, upper + kRow, 2 * sizeof *half);
      c.channel[i] = from_halves(half) * scale;
    }
    return c;
  }

 private:
  struct alignas(64) Packed {
    // A channel after the other, of each the texels' two rows; the last two have the scale's bits.
    std::array<std::uint16_t, 3 * kTexels + 2> half{};
    float scale() const {
      return std::bit_cast<float>(std::uint32_t{half[30]} | std::uint32_t{half[31]} << 16);
    }
    void set_scale(float scale) {
      const auto bits = std::bit_cast<std::uint32_t>(scale);
      half[30] = static_cast<std::uint16_t>(bits);
      half[31] = static_cast<std::uint16_t>(bits >> 16);
    }
  };

  static float sum(const Floats& v) { return (v[0] + v[1]) + (v[2] + v[3]); }
  static Floats shares(const V2f& p) {
    const float x = 1.0f - p.x, y = 1.0f - p.y;
    return Floats{x, p.x, x, p.x} * Floats{y, y, p.y, p.y};
  }
  // Of positive ones that are not denormal, or 0.
  static Floats from_halves(const std::uint16_t* four) {
    using Halves = std::uint16_t __attribute__((vector_size(8)));
    using Words = std::uint32_t __attribute__((vector_size(16)));
    Halves half;
    std::memcpy(&half, four, sizeof half);
    return std::bit_cast<Floats>(__builtin_convertvector(half, Words) << 13) * 0x1p112f;
  }
  std::size_t index(int row, int block) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(blocks_) +
           static_cast<std::size_t>(block);
  }

  int width_, height_, blocks_;
  std::vector<Packed, HugePageAllocator<Packed>> packed_;
};

}  // namespace morsel::render

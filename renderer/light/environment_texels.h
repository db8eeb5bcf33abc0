// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstdint>
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
  static constexpr int kPatches = 4;  // of a block
  using Row = std::array<V3f, kPatches + 1>;
  struct Block {
    Row upper, lower;
  };
  // Of the four texels about a patch.
  template <typename T>
  struct Corners {
    T a, b, c, d;  // upper left and right, lower left and right
    T at(const V2f& p) const {
      return (a * (1.0f - p.x) + b * p.x) * (1.0f - p.y) + (c * (1.0f - p.x) + d * p.x) * p.y;
    }
  };

  // `image` has as many texels as it says, finite and >= 0.
  explicit EnvironmentTexels(const EnvironmentImage& image);

  int width() const { return width_; }
  int height() const { return height_; }
  int blocks() const { return blocks_; }  // of a row; the last may have fewer patches

  void prefetch(int row, int block) const { __builtin_prefetch(&packed_[index(row, block)]); }
  // row: 0 .. height.
  Block block(int row, int block) const {
    const Packed& from = packed_[index(row, block)];
    float value[kHalves];
    for (int i = 0; i < kHalves; ++i) value[i] = from_half(from.half[i]) * from.scale();
    Block b;
    for (std::size_t i = 0; i < b.upper.size(); ++i) {
      b.upper[i] = V3f(value[3 * i], value[3 * i + 1], value[3 * i + 2]);
      const float* lower = value + kRow;
      b.lower[i] = V3f(lower[3 * i], lower[3 * i + 1], lower[3 * i + 2]);
    }
    return b;
  }
  // column: 0 .. width - 1.
  Corners<V3f> corners(int row, int column) const {
    const Packed& from = packed_[index(row, column / kPatches)];
    const int first = 3 * (column % kPatches);
    const float scale = from.scale();
    const auto texel = [&](int i) {
      return V3f(from_half(from.half[i]), from_half(from.half[i + 1]),
                 from_half(from.half[i + 2])) *
             scale;
    };
    return {texel(first), texel(first + 3), texel(first + kRow), texel(first + kRow + 3)};
  }

 private:
  static constexpr int kRow = 3 * (kPatches + 1), kHalves = 32;
  struct alignas(64) Packed {
    // Two rows of texels; the bits of the scale are in the last two.
    std::array<std::uint16_t, kHalves> half{};
    float scale() const {
      return std::bit_cast<float>(std::uint32_t{half[30]} | std::uint32_t{half[31]} << 16);
    }
    void set_scale(float scale) {
      const auto bits = std::bit_cast<std::uint32_t>(scale);
      half[30] = static_cast<std::uint16_t>(bits);
      half[31] = static_cast<std::uint16_t>(bits >> 16);
    }
  };

  // Of a positive one that is not denormal, or 0.
  static float from_half(std::uint16_t half) {
    return std::bit_cast<float>(std::uint32_t{half} << 13) * 0x1p112f;
  }
  std::size_t index(int row, int block) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(blocks_) +
           static_cast<std::size_t>(block);
  }

  int width_, height_, blocks_;
  std::vector<Packed, HugePageAllocator<Packed>> packed_;
};

}  // namespace morsel::render

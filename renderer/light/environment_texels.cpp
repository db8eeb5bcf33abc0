// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/environment_texels.h"

#include <cmath>

#include "renderer/light/environment.h"

namespace morsel::render {
namespace {

// The half nearest to x in [0, 2^15]; ties go away from 0. Denormal ones become 0.
std::uint16_t to_half(float x) {
  if (x < 0x1p-14f) return 0;
  const auto rounded = std::bit_cast<std::uint32_t>(x) + 0x1000u;
  return static_cast<std::uint16_t>((rounded - (112u << 23)) >> 13);
}

}  // namespace

EnvironmentTexels::EnvironmentTexels(const EnvironmentImage& image)
    : width_(image.width),
      height_(image.height),
      blocks_((image.width + kPatches - 1) / kPatches),
      packed_(static_cast<std::size_t>(height_ + 1) * static_cast<std::size_t>(blocks_)) {
  const auto texel = [&](int x, int y) -> const V3f& {
    return image.texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                        static_cast<std::size_t>(x % width_)];
  };
  for (int row = 0; row <= height_; ++row)
    for (int block = 0; block < blocks_; ++block) {
      const int rows[] = {std::max(row - 1, 0), std::min(row, height_ - 1)};
      float brightest = 0.0f;
      for (const int y : rows)
        for (int i = 0; i <= kPatches; ++i)
          brightest = std::max(brightest, max_component(texel(block * kPatches + i, y)));
      // The brightest in [2^14, 2^15); the scale itself must be a number above 0.
      int exponent = 0;
      std::frexp(brightest, &exponent);
      exponent = std::max(exponent - 15, -126);
      Packed& to = packed_[index(row, block)];
      to.set_scale(std::ldexp(1.0f, exponent));
      std::size_t at = 0;
      for (const int y : rows)
        for (int i = 0; i <= kPatches; ++i) {
          const V3f& t = texel(block * kPatches + i, y);
          for (std::size_t c = 0; c < 3; ++c)
            to.half[c * kTexels + at] = to_half(std::ldexp(t[static_cast<int>(c)], -exponent));
          ++at;
        }
    }
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>

#include "renderer/sampler/owen_sobol.h"

namespace morsel::render {

// Random numbers of one sample of one pixel: a pure function of (seed, pixel, sample, dimension),
// so images depend neither on threads nor on tiles, and a crop has the pixels of the full image.
//
// Each dimension is an independent Owen-scrambled Sobol sequence over the samples of the pixel
// ("padding"): indices are shuffled per pixel and dimension, then the point is scrambled. Over the
// first 2^k samples of a pixel every one- or two-dimensional sample set is a (0, k, 2)-net.
class PixelSampler {
 public:
  // `x`, `y`: pixel of the full image.
  PixelSampler(int x, int y, std::uint32_t seed)
      : pixel_(combine_bits(combine_bits(mix_bits(seed), static_cast<std::uint32_t>(x)),
                            static_cast<std::uint32_t>(y))) {}

  void start_sample(std::uint32_t index) { reversed_index_ = reverse_bits(index); }

  // In [0, 1). One- and two-dimensional uses must not share a dimension number.
  float get_1d(std::uint32_t dimension) const {
    const std::uint32_t key = key_of(dimension);
    const std::uint32_t index = owen_shuffle(reversed_index_, key);
    return to_unit_float(reverse_bits(owen_hash(index, mix_bits(key ^ 0x68bc21ebu))));
  }
  Imath::V2f get_2d(std::uint32_t dimension) const {
    const std::uint32_t key = key_of(dimension);
    const std::uint32_t index = owen_shuffle(reversed_index_, key);
    return {to_unit_float(reverse_bits(owen_hash(index, mix_bits(key ^ 0x68bc21ebu)))),
            to_unit_float(reverse_bits(
                owen_hash(sobol_second_reversed(index), mix_bits(key ^ 0x02e5be93u))))};
  }

 private:
  // combine_bits(pixel_, dimension); most dimensions are small.
  std::uint32_t key_of(std::uint32_t dimension) const {
    static constexpr auto kMixed = [] {
      std::array<std::uint32_t, 64> mixed{};
      for (std::uint32_t i = 0; i < mixed.size(); ++i) mixed[i] = mix_bits(i);
      return mixed;
    }();
    return combine_mixed(pixel_,
                         dimension < kMixed.size() ? kMixed[dimension] : mix_bits(dimension));
  }

  std::uint32_t pixel_;
  std::uint32_t reversed_index_ = 0;
};

}  // namespace morsel::render

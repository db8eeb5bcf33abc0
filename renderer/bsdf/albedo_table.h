// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>

#include "renderer/math/vector.h"

namespace morsel::render {

// A quantity in [0, 1] that depends on the viewing cosine and a roughness: the share of light that
// some lobe reflects. Piecewise linear in sqrt(cosine), since it changes fastest towards grazing
// angles, and in the perceptual roughness.
class AlbedoTable {
 public:
  static constexpr int kCosines = 32, kRoughnesses = 24;

  // All 0.
  AlbedoTable() = default;
  // `integrate(cosine, roughness)` is called for every entry; roughness 0 included.
  explicit AlbedoTable(const std::function<float(float, float)>& integrate);

  // Where a number lies between two entries. Those of one lobe or direction can be kept: they are
  // square roots, and several tables are asked at the same place.
  struct Place {
    int index;
    float fraction;
  };
  // cos_theta in (0, 1].
  static Place cosine_place(float cos_theta) {
    return place(std::sqrt(std::clamp(cos_theta, 0.0f, 1.0f)), kCosines);
  }
  // alpha = roughness^2 in [0, 1].
  static Place alpha_place(float alpha) {
    return place(std::sqrt(std::clamp(alpha, 0.0f, 1.0f)), kRoughnesses);
  }

  float at(const Place& cosine, const Place& alpha) const {
    const auto in_row = [&](int r) {
      const auto& values = value_[static_cast<std::size_t>(r)];
      const auto i = static_cast<std::size_t>(cosine.index);
      return values[i] + cosine.fraction * (values[i + 1] - values[i]);
    };
    return (1.0f - alpha.fraction) * in_row(alpha.index) + alpha.fraction * in_row(alpha.index + 1);
  }
  float operator()(float cos_theta, float alpha) const {
    return at(cosine_place(cos_theta), alpha_place(alpha));
  }
  // Mean over the hemisphere of incident light, weighted by the cosine: 2 int E(mu) mu dmu.
  float average(const Place& alpha) const {
    const auto i = static_cast<std::size_t>(alpha.index);
    return (1.0f - alpha.fraction) * average_[i] + alpha.fraction * average_[i + 1];
  }
  float average(float alpha) const { return average(alpha_place(alpha)); }

  static float cosine_of(int c) {
    return square(std::max(static_cast<float>(c) / (kCosines - 1), 1e-3f));
  }
  static float roughness_of(int r) { return static_cast<float>(r) / (kRoughnesses - 1); }

 private:
  // Of x in [0, 1] among `count` entries. What is no number is in the last pair, as no number.
  static Place place(float x, int count) {
    const float scaled = x * static_cast<float>(count - 1);
    const int index = scaled < static_cast<float>(count - 2) ? static_cast<int>(scaled) : count - 2;
    return {index, scaled - static_cast<float>(index)};
  }

  std::array<std::array<float, kCosines>, kRoughnesses> value_{};
  std::array<float, kRoughnesses> average_{};
};

}  // namespace morsel::render

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

  // cos_theta in (0, 1], alpha = roughness^2 in [0, 1].
  float operator()(float cos_theta, float alpha) const {
    const float c = std::sqrt(std::clamp(cos_theta, 0.0f, 1.0f)) * (kCosines - 1);
    const Row row(alpha);
    const int c0 = std::min(static_cast<int>(c), kCosines - 2);
    const float fc = c - static_cast<float>(c0);
    const auto at = [&](int r) {
      const auto& values = value_[static_cast<std::size_t>(r)];
      const auto i = static_cast<std::size_t>(c0);
      return values[i] + fc * (values[i + 1] - values[i]);
    };
    return (1.0f - row.fraction) * at(row.index) + row.fraction * at(row.index + 1);
  }
  // Mean over the hemisphere of incident light, weighted by the cosine: 2 int E(mu) mu dmu.
  float average(float alpha) const {
    const Row row(alpha);
    const auto i = static_cast<std::size_t>(row.index);
    return (1.0f - row.fraction) * average_[i] + row.fraction * average_[i + 1];
  }

  static float cosine_of(int c) {
    return square(std::max(static_cast<float>(c) / (kCosines - 1), 1e-3f));
  }
  static float roughness_of(int r) { return static_cast<float>(r) / (kRoughnesses - 1); }

 private:
  struct Row {
    int index;
    float fraction;
    explicit Row(float alpha) {
      const float r = std::sqrt(std::clamp(alpha, 0.0f, 1.0f)) * (kRoughnesses - 1);
      index = std::min(static_cast<int>(r), kRoughnesses - 2);
      fraction = r - static_cast<float>(index);
    }
  };
  std::array<std::array<float, kCosines>, kRoughnesses> value_{};
  std::array<float, kRoughnesses> average_{};
};

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/albedo_table.h"

namespace morsel::render {

AlbedoTable::AlbedoTable(const std::function<float(float, float)>& integrate) {
  for (int r = 0; r < kRoughnesses; ++r) {
    const auto row = static_cast<std::size_t>(r);
    for (int c = 0; c < kCosines; ++c)
      value_[row][static_cast<std::size_t>(c)] =
          std::clamp(integrate(cosine_of(c), roughness_of(r)), 0.0f, 1.0f);
    // With mu = s^2 the table is linear in s: 2 int E mu dmu = 4 int E(s) s^3 ds.
    double sum = 0.0;
    constexpr int kSteps = 1024;
    for (int i = 0; i < kSteps; ++i) {
      const double s = (i + 0.5) / kSteps;
      const double c = s * (kCosines - 1);
      const int c0 = std::min(static_cast<int>(c), kCosines - 2);
      const double f = c - c0;
      const auto k = static_cast<std::size_t>(c0);
      sum += ((1.0 - f) * value_[row][k] + f * value_[row][k + 1]) * 4.0 * s * s * s;
    }
    average_[row] = static_cast<float>(sum / kSteps);
  }
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "renderer/math/vector.h"

// Statistics that the renderer's tests share.
namespace morsel::render::testing {

// Reproducible uniform numbers in [0, 1).
class Random {
 public:
  explicit Random(unsigned seed = 1) : engine_(seed) {}
  float operator()() { return static_cast<float>(engine_() >> 8) * 0x1p-24f; }
  V2f pair() {
    const float x = (*this)();
    return {x, (*this)()};
  }
  V3f direction() {
    const float z = 2.0f * (*this)() - 1.0f, phi = 2.0f * kPi * (*this)();
    const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
  }

 private:
  std::mt19937 engine_;
};

// The sphere in cells of equal solid angle: rows in x, columns in azimuth about the x axis. (Lobes
// tend to lie about the z axis, and the grid is coarse at its own poles.)
struct SphereGrid {
  int rows = 32, columns = 64;

  int size() const { return rows * columns; }
  int cell(const V3f& w) const {
    const int row = std::min(rows - 1, static_cast<int>((w.x + 1.0f) * 0.5f * rows));
    const float turn = std::atan2(w.z, w.y) / (2.0f * kPi) + 0.5f;
    const int column = std::min(columns - 1, static_cast<int>(turn * columns));
    return row * columns + column;
  }
  // Midpoint rule with `fine` x `fine` points in each cell.
  std::vector<double> integrate(const std::function<double(const V3f&)>& f, int fine) const {
    std::vector<double> out(static_cast<std::size_t>(size()));
    const double weight = 4.0 * kPi / (static_cast<double>(size()) * fine * fine);
    for (int r = 0; r < rows * fine; ++r) {
      const double x = -1.0 + 2.0 * (r + 0.5) / (rows * fine), s = std::sqrt(1.0 - x * x);
      for (int c = 0; c < columns * fine; ++c) {
        const double phi = 2.0 * kPi * ((c + 0.5) / (columns * fine) - 0.5);
        const V3f w(V3d(x, s * std::cos(phi), s * std::sin(phi)));
        out[static_cast<std::size_t>((r / fine) * columns + c / fine)] += weight * f(w);
      }
    }
    return out;
  }
};

struct ChiSquared {
  double p_value = 0.0;       // probability of a fit this bad or worse if the densities agree
  double pdf_integral = 0.0;  // over the sphere
  double accepted = 0.0;      // share of calls that gave a direction
};

// Do the directions that `sample` draws (it may decline) have density `pdf`?
inline ChiSquared chi_squared(const std::function<std::optional<V3f>(Random&)>& sample,
                              const std::function<double(const V3f&)>& pdf, int samples = 200000,
                              int fine = 24, unsigned seed = 7) {
  const SphereGrid grid;
  const std::vector<double> density = grid.integrate(pdf, fine);
  std::vector<double> observed(density.size());
  Random random(seed);
  ChiSquared result;
  for (int i = 0; i < samples; ++i)
    if (const auto w = sample(random)) {
      observed[static_cast<std::size_t>(grid.cell(*w))] += 1.0;
      result.accepted += 1.0 / samples;
    }
  // Cells that expect few are pooled, also with "declined", which expects the rest.
  double statistic = 0.0, pooled_observed = samples * (1.0 - result.accepted);
  double pooled_expected = samples;
  int degrees = 0;
  for (std::size_t i = 0; i < density.size(); ++i) {
    result.pdf_integral += density[i];
    const double expected = density[i] * samples;
    if (expected < 20.0) {
      pooled_observed += observed[i];
      continue;
    }
    pooled_expected -= expected;
    statistic += (observed[i] - expected) * (observed[i] - expected) / expected;
    ++degrees;
  }
  if (pooled_expected > 20.0)
    statistic +=
        (pooled_observed - pooled_expected) * (pooled_observed - pooled_expected) / pooled_expected;
  else
    --degrees;
  // Wilson & Hilferty: the cube root of chi^2 / k is nearly normal.
  const double k = std::max(1, degrees), v = 2.0 / (9.0 * k);
  const double z = (std::cbrt(statistic / k) - (1.0 - v)) / std::sqrt(v);
  result.p_value = 0.5 * std::erfc(z / std::sqrt(2.0));
  return result;
}

inline double sphere_integral(const std::function<double(const V3f&)>& f, int fine = 24) {
  double sum = 0.0;
  for (const double x : SphereGrid{}.integrate(f, fine)) sum += x;
  return sum;
}

}  // namespace morsel::render::testing

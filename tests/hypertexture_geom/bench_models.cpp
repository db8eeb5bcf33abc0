// SPDX-License-Identifier: Apache-2.0
// How tight local models are: (width of the bound) / (sampled range) on boxes that meet the surface
// of equation (13), for box sides of 1/10, 1/5 and 2/5 of the finest kernel radius. Median and 95th
// percentile over boxes; for the gradient each component counts. The sampled range comes from a
// grid of 17^3 points, so true ratios are a little smaller.
//   bench_models [LAYERS [BOXES]]
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "tests/hypertexture_geom/test_fields.h"

namespace {

using namespace morsel;

std::pair<double, double> median_and_95(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return {v[v.size() / 2], v[v.size() * 95 / 100]};
}

void measure(const topology::ScalarField& field, double side, int boxes) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<double> value, slope;
  while (static_cast<int>(value.size()) < boxes) {
    const Imath::V3d c(2.0 * unit(random), 2.0 * unit(random), 2.0 * unit(random));
    const topology::Box box(c - Imath::V3d(0.5 * side), c + Imath::V3d(0.5 * side));
    const auto local = field.restricted_to(box);
    topology::Interval seen{1e300, -1e300}, slopes[3] = {seen, seen, seen};
    constexpr int kSteps = 16;
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; j <= kSteps; ++j)
        for (int k = 0; k <= kSteps; ++k) {
          const topology::Jet jet = local->jet(box.min + Imath::V3d(i, j, k) * (side / kSteps));
          seen = {std::min(seen.lo, jet.value), std::max(seen.hi, jet.value)};
          for (int a = 0; a < 3; ++a)
            slopes[a] = {std::min(slopes[a].lo, jet.gradient[a]),
                         std::max(slopes[a].hi, jet.gradient[a])};
        }
    if (seen.lo > 0.0 || seen.hi < 0.0) continue;
    const topology::LocalModel m = local->model(box);
    value.push_back(m.range().width() / seen.width());
    for (int a = 0; a < 3; ++a) slope.push_back(m.gradient_range(a).width() / slopes[a].width());
  }
  const auto [v50, v95] = median_and_95(value);
  const auto [g50, g95] = median_and_95(slope);
  fmt::print("side {:<10.4g} value {:6.3f} {:6.3f}   gradient {:6.3f} {:6.3f}\n", side, v50, v95,
             g50, g95);
}

}  // namespace

int main(int argc, char** argv) {
  const int layers = argc > 1 ? std::atoi(argv[1]) : 1, boxes = argc > 2 ? std::atoi(argv[2]) : 400;
  const auto field = geom::testing::field_of(geom::testing::eq13_json(layers, 1));
  const double radius = 1.0 / (3.0 * (1 << (layers - 1)));
  fmt::print("equation (13), {} layers, {} boxes: median and 95 % of bound / sampled range\n",
             layers, boxes);
  for (const double part : {0.1, 0.2, 0.4}) measure(*field, part * radius, boxes);
}

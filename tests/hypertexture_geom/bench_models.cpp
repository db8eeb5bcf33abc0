// SPDX-License-Identifier: Apache-2.0
// How tight local models are: (width of the bound) / (sampled range) on boxes that meet the
// surface. Median and 95th percentile over boxes; for the gradient each component counts. The
// sampled range comes from a grid of 17^3 points (9^3 for all kinds), so true ratios are a little
// smaller.
//   bench_models [LAYERS [BOXES]]   equation (13), sides of 1/10, 1/5 and 2/5 of the finest kernel
//   radius bench_models kinds [BOXES]      every kind of field, boxes of sides 1/4 to 1/256
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <string_view>

#include "tests/hypertexture_geom/test_fields.h"

namespace {

using namespace morsel;
using nlohmann::json;

std::string median_and_95(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return fmt::format("{:8.3f} {:8.3f}", v[v.size() / 2], v[v.size() * 95 / 100]);
}

struct Ratios {
  std::vector<double> value, slope;
};

Ratios measure(const topology::ScalarField& field, double side, int boxes, int steps) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Ratios r;
  const auto width = [](topology::Interval bound, topology::Interval seen) {
    return bound.width() / std::max(seen.width(), 1e-300);
  };
  while (static_cast<int>(r.value.size()) < boxes) {
    const Imath::V3d c(2.0 * unit(random), 2.0 * unit(random), 2.0 * unit(random));
    const topology::Box box(c - Imath::V3d(0.5 * side), c + Imath::V3d(0.5 * side));
    // Far from the surface, if slopes are what they usually are: not worth sampling.
    if (std::abs(field.value(c)) > 16.0 * side) continue;
    const auto local = field.restricted_to(box);
    topology::Interval seen{1e300, -1e300}, slopes[3] = {seen, seen, seen};
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; j <= steps; ++j)
        for (int k = 0; k <= steps; ++k) {
          const topology::Jet jet = local->jet(box.min + Imath::V3d(i, j, k) * (side / steps));
          seen = {std::min(seen.lo, jet.value), std::max(seen.hi, jet.value)};
          for (int a = 0; a < 3; ++a)
            slopes[a] = {std::min(slopes[a].lo, jet.gradient[a]),
                         std::max(slopes[a].hi, jet.gradient[a])};
        }
    if (seen.lo > 0.0 || seen.hi < 0.0) continue;
    const topology::LocalModel m = local->model(box);
    r.value.push_back(width(m.range(), seen));
    for (int a = 0; a < 3; ++a) r.slope.push_back(width(m.gradient_range(a), slopes[a]));
  }
  return r;
}

// One field of every kind; the sphere under the modulations has radius 1.
std::vector<std::pair<std::string, json>> kinds() {
  std::vector<std::pair<std::string, json>> all;
  const auto density = [&](const std::string& name, json d) {
    d["type"] = name;
    all.emplace_back(name, json{{"density", std::move(d)}});
  };
  density("sphere", json::object());
  density("ellipsoid", {{"radii", {1.2, 0.8, 0.6}}});
  density("rounded_box", {{"half_size", {1.0, 0.8, 0.6}}, {"rounding", 0.2}});
  density("torus", {{"axis", {1, 2, 3}}});
  density("capsule", json::object());
  density("slab", {{"axis", {1, 2, 3}}});
  density("metaballs", {{"balls", {{{"center", {-0.5, 0, 0}}}, {{"center", {0.5, 0.2, 0}}}}}});
  const json parts{{{"type", "sphere"}, {"radius", 0.8}},
                   {{"type", "sphere"}, {"radius", 0.8}, {"center", {0.9, 0.1, 0.2}}},
                   {{"type", "torus"}, {"major_radius", 0.9}}};
  for (const char* name : {"union", "intersection", "difference"})
    density(name, {{"densities", parts}});
  const auto modulated = [&](const std::string& name, json modulations) {
    all.emplace_back(
        name, json{{"density", {{"type", "sphere"}}}, {"modulations", std::move(modulations)}});
  };
  const json noise{{"amplitude", 0.3}, {"frequency", 3}, {"layers", 2}, {"seed", 1}};
  const auto with = [&](const char* type, json extra = json::object()) {
    json m = noise;
    m["type"] = type;
    m.update(extra);
    return m;
  };
  for (const char* basis : {"sparse_convolution", "perlin"}) {
    const json b{{"noise", basis}};
    const std::string of = basis[0] == 'p' ? " of perlin" : "";
    for (const char* type : {"fbm", "turbulence", "ridged"}) modulated(type + of, {with(type, b)});
    modulated("fbm, masked" + of,
              {with("fbm", {{"noise", basis},
                            {"mask", {{"type", "height"}, {"from", -0.5}, {"to", 0.5}}}})});
    json warp = with("warp", b);
    warp["amplitude"] = 0.1;
    warp["layers"] = 1;
    modulated("warp" + of, {warp});
    modulated("fbm under warp" + of, {with("fbm", b), warp});
  }
  modulated("bias", {with("fbm"), {{"type", "bias"}, {"bias", 0.7}}});
  modulated("gain", {with("fbm"), {{"type", "gain"}, {"gain", 0.7}}});
  modulated("scale_offset", {with("fbm"), {{"type", "scale_offset"}, {"scale", 0.5}}});
  return all;
}

int all_kinds(int boxes, std::string_view part_of_name) {
  fmt::print(
      "{} boxes that meet the surface: median and 95 % of bound / sampled range\n{:24}{:>8}  "
      "{:^17}   {:^17}\n",
      boxes, "", "side", "value", "gradient");
  for (const auto& [name, description] : kinds()) {
    if (name.find(part_of_name) == std::string::npos) continue;
    const auto field = geom::testing::field_of(description);
    for (const int part : {4, 16, 64, 256}) {
      const Ratios r = measure(*field, 1.0 / part, boxes, 8);
      fmt::print("{:24}{:>8}  {}   {}\n", name, fmt::format("1/{}", part), median_and_95(r.value),
                 median_and_95(r.slope));
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const int boxes = argc > 2 ? std::atoi(argv[2]) : 400;
  if (argc > 1 && std::string_view(argv[1]) == "kinds")
    return all_kinds(argc > 2 ? boxes : 100, argc > 3 ? argv[3] : "");
  const int layers = argc > 1 ? std::atoi(argv[1]) : 1;
  const auto field = geom::testing::field_of(geom::testing::eq13_json(layers, 1));
  const double radius = 1.0 / (3.0 * (1 << (layers - 1)));
  fmt::print("equation (13), {} layers, {} boxes: median and 95 % of bound / sampled range\n",
             layers, boxes);
  for (const double part : {0.1, 0.2, 0.4}) {
    const Ratios r = measure(*field, part * radius, boxes, 16);
    fmt::print("side {:<10.4g} value {}   gradient {}\n", part * radius, median_and_95(r.value),
               median_and_95(r.slope));
  }
}

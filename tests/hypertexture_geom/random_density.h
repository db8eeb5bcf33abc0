// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

namespace morsel::geom::testing {

// The densities that stand by themselves.
inline const std::vector<std::string>& simple_densities() {
  static const std::vector<std::string> names{"sphere",  "ellipsoid", "rounded_box", "torus",
                                              "capsule", "slab",      "metaballs"};
  return names;
}

inline const std::vector<std::string>& boolean_densities() {
  static const std::vector<std::string> names{"union", "intersection", "difference"};
  return names;
}

// Random parameters of a density near the origin, as scene JSON; smoothing from 1e-4 to 0.1, about
// one in four oblique axes along a coordinate axis.
inline nlohmann::json random_density(const std::string& type, std::mt19937_64& random,
                                     int depth = 2) {
  using nlohmann::json;
  const auto between = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  const auto vector = [&](double lo, double hi) {
    return json{between(lo, hi), between(lo, hi), between(lo, hi)};
  };
  const auto axis = [&] {
    json a = vector(-1.0, 1.0);
    if (random() % 4 == 0) {
      a = {0.0, 0.0, 0.0};
      a[random() % 3] = between(0.1, 2.0);
    }
    return a;
  };
  const double smoothing = std::pow(10.0, between(-4.0, -1.0));
  json d{{"type", type}};
  if (type == "union" || type == "intersection" || type == "difference") {
    d["width"] = std::pow(10.0, between(-3.0, 0.0));
    const int parts = 2 + static_cast<int>(random() % 2);
    for (int i = 0; i < parts; ++i) {
      const bool nested = depth > 1 && random() % 3 == 0;
      const auto& names = nested ? boolean_densities() : simple_densities();
      d["densities"].push_back(random_density(names[random() % names.size()], random, depth - 1));
    }
    return d;
  }
  if (type == "metaballs") {
    for (int i = 0; i < 4; ++i)
      d["balls"].push_back({{"center", vector(-1.0, 1.0)},
                            {"radius", between(0.3, 1.5)},
                            {"weight", between(-0.5, 1.5)}});
    d["level"] = between(0.05, 0.5);
    return d;
  }
  d["smoothing"] = smoothing;
  if (type != "capsule") d["center"] = vector(-0.5, 0.5);
  if (type == "sphere") d["radius"] = between(0.3, 1.5);
  if (type == "ellipsoid") d["radii"] = vector(0.2, 1.5);
  if (type == "rounded_box") {
    d["half_size"] = vector(0.3, 1.2);
    d["rounding"] = between(0.21, 0.3);
    d["crown"] = between(0.0, 0.5);
  }
  if (type == "torus") {
    d["axis"] = axis();
    d["major_radius"] = between(0.1, 1.2);
    d["minor_radius"] = between(0.15, 0.5);
  }
  if (type == "capsule") {
    d["start"] = vector(-1.0, 0.0);
    d["end"] = vector(0.1, 1.0);
    d["radius"] = between(0.21, 0.6);
    d["crown"] = between(0.0, 0.5);
  }
  if (type == "slab") {
    d["axis"] = axis();
    d["half_thickness"] = between(0.15, 0.8);
  }
  return d;
}

}  // namespace morsel::geom::testing

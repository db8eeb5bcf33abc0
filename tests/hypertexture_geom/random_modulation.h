// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

namespace morsel::geom::testing {

// Modulations with random parameters, as scene JSON.
class RandomModulation {
 public:
  explicit RandomModulation(std::mt19937_64& random) : random_(random) {}

  nlohmann::json of(const std::string& type) {
    if (type == "scale_offset")
      return {{"type", type}, {"scale", uniform(-2.0, 2.0)}, {"offset", uniform(-0.5, 0.5)}};
    if (type == "bias" || type == "gain") {
      const double from = uniform(-0.5, 0.5);
      return {{"type", type},
              {type, uniform(0.02, 0.98)},
              {"from", from},
              {"to", from + logarithmic(0.05, 2.0)}};
    }
    nlohmann::json m{{"type", type},
                     {"amplitude", uniform(-0.8, 0.8)},
                     {"frequency", logarithmic(0.5, 4.0)},
                     {"layers", integer(1, 3)},
                     {"hurst", uniform(0.3, 1.2)},
                     {"seed", integer(0, 1000)},
                     {"impulses_per_cell", integer(1, 4)}};
    if (type == "turbulence" || type == "ridged") m["smoothing"] = logarithmic(1e-3, 1.0);
    if (type == "ridged") {
      m["offset"] = uniform(-0.5, 1.5);
      m["squared"] = integer(0, 1) == 1;
    }
    if (type == "warp") m["amplitude"] = uniform(-0.2, 0.2);
    if (integer(0, 2) == 0) m["mask"] = mask();
    if (integer(0, 2) == 0) {
      m["noise"] = "perlin";
      m.erase("impulses_per_cell");
    }
    return m;
  }

  nlohmann::json mask() {
    const double from = uniform(-1.0, 1.0),
                 to = from + (integer(0, 1) ? 1.0 : -1.0) * uniform(0.1, 1.5);
    if (integer(0, 1) == 0)
      return {{"type", "height"},
              {"axis", std::string(1, static_cast<char>('x' + integer(0, 2)))},
              {"from", from},
              {"to", to}};
    return {{"type", "density"},
            {"density",
             {{"type", "sphere"},
              {"radius", uniform(0.3, 1.5)},
              {"center", {uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0)}}}},
            {"from", 0.3 * from},
            {"to", 0.3 * to}};
  }

  // A sphere with a sequence of modulations.
  nlohmann::json field(const std::vector<std::string>& types) {
    nlohmann::json f{{"density", {{"type", "sphere"}, {"radius", 1.0}, {"smoothing", 0.05}}},
                     {"modulations", nlohmann::json::array()}};
    for (const std::string& type : types) f["modulations"].push_back(of(type));
    return f;
  }

  double uniform(double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random_);
  }
  double logarithmic(double a, double b) { return std::exp(uniform(std::log(a), std::log(b))); }
  int integer(int a, int b) { return std::uniform_int_distribution<int>(a, b)(random_); }

 private:
  std::mt19937_64& random_;
};

}  // namespace morsel::geom::testing

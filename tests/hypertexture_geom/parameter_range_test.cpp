// SPDX-License-Identifier: Apache-2.0
// Every parameter of every density, modulation and mask refuses what is out of its declared range,
// of another type, or unknown, and says where, what and what would do.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hypertexture_geom/field/mask.h"
#include "hypertexture_geom/field/registry.h"
#include "tests/hypertexture_geom/random_density.h"
#include "tests/hypertexture_geom/random_modulation.h"
#include "tests/hypertexture_geom/test_fields.h"

namespace morsel::geom {
namespace {

using nlohmann::json;
using params::Declaration;
using params::Parameter;
using params::Type;

std::string error_of(const json& field) {
  try {
    testing::field_of(field);
  } catch (const params::InputError& e) {
    return e.what();
  }
  return "";
}

class ParameterRanges {
 public:
  // `pointer` is where in `field`, which is valid, an object of this declaration is.
  void check(const json& field, const std::string& pointer, const Declaration& declaration) {
    ASSERT_EQ(error_of(field), "") << field;
    for (const Parameter& p : declaration.parameters) {
      const std::string at = pointer + "/" + p.name;
      const auto refused = [&](const json& value, const std::string& shown) {
        json bad = field;
        bad[json::json_pointer(at)] = value;
        const std::string error = error_of(bad);
        EXPECT_NE(error.find(at), std::string::npos) << error << " for " << bad;
        EXPECT_NE(error.find(shown), std::string::npos) << error << " should name " << shown;
        ++checked_;
      };
      if (p.type == Type::kNumber || p.type == Type::kInteger) {
        refused("many", "many");
        refused(nullptr, "null");
        const auto number = [&](double x) {
          if (p.type == Type::kInteger)
            refused(static_cast<std::int64_t>(x), fmt::format("{}", static_cast<std::int64_t>(x)));
          else
            refused(x, fmt::format("{:.15g}", x));
        };
        if (std::isfinite(p.min)) number(p.exclusive_min ? p.min : p.min - 1.0);
        if (std::isfinite(p.max)) number(p.max + 1.0);
      }
      if (p.type == Type::kInteger) refused(1.5, "1.5");
      const bool vector = p.type == Type::kVector3 || p.type == Type::kNumberOrVector3;
      if (vector) {
        refused(json::array({1.0, 2.0}), "3");
        refused("up", "up");
        for (std::size_t i = 0; i < 3; ++i)
          for (const double x : {p.exclusive_min ? p.min : p.min - 1.0, p.max + 1.0, -1e300, 1e300,
                                 std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::quiet_NaN()}) {
            json bad = json::array({0.5, 0.5, 0.5});
            bad[i] = x;
            refused(bad, fmt::format("{}/{}: ", at, i));
          }
      }
      // No number of a field is without a range.
      if (vector || p.type == Type::kNumber || p.type == Type::kInteger) {
        EXPECT_TRUE(std::isfinite(p.min) && std::isfinite(p.max)) << declaration.name << p.name;
      }
      if (p.record != nullptr && p.type == Type::kArray) check(field, at + "/0", *p.record);
      if (p.type == Type::kChoice) refused("nothing", p.choices.front());
      if (p.type == Type::kBoolean) refused(1, "1");
      if (p.type == Type::kArray) {
        refused(json::object(), "{}");
        if (std::isfinite(p.min)) refused(json::array(), fmt::format("{}", p.min));
      }
    }
    json bad = field;
    bad[json::json_pointer(pointer + "/nonsense")] = 1;
    EXPECT_NE(error_of(bad).find(pointer + "/nonsense"), std::string::npos) << error_of(bad);
  }
  int checked() const { return checked_; }

 private:
  int checked_ = 0;
};

TEST(ParameterRanges, AreChecked) {
  std::mt19937_64 random(51);
  ParameterRanges ranges;
  for (const DensityEntry& d : densities()) {
    const json field{{"density", testing::random_density(d.declaration.name, random)}};
    ranges.check(field, "/density", d.declaration);
  }
  testing::RandomModulation make(random);
  for (const ModulationEntry& m : modulations()) {
    json field = make.field({m.declaration.name});
    json& modulation = field["modulations"][0];
    if (modulation.contains("noise")) {
      modulation["noise"] = "sparse_convolution";
      modulation["impulses_per_cell"] = 2;
    }
    ranges.check(field, "/modulations/0", m.declaration);
  }
  json field = make.field({"fbm"});
  json& mask = field["modulations"][0]["mask"];
  mask = {{"type", "height"}, {"axis", "x"}, {"from", 0.0}, {"to", 1.0}};
  ranges.check(field, "/modulations/0/mask", *mask_declarations()[0]);
  mask = {{"type", "density"}, {"density", {{"type", "sphere"}}}, {"from", 0.0}, {"to", 1.0}};
  ranges.check(field, "/modulations/0/mask", *mask_declarations()[1]);
  EXPECT_GT(ranges.checked(), 200);
}

TEST(ParameterRanges, EmptyCompositionsAreErrors) {
  const auto names = [](const json& field, const char* what) {
    const std::string error = error_of(field);
    EXPECT_NE(error.find(what), std::string::npos) << error << " for " << field;
  };
  names(json::object(), "density");
  names({{"density", json::object()}}, "type");
  names({{"density", nullptr}}, "/density");
  names({{"density", {{"type", "union"}}}}, "densities");
  names({{"density", {{"type", "union"}, {"densities", json::array()}}}}, "/density/densities");
  names({{"density", {{"type", "union"}, {"densities", {{{"type", "sphere"}}}}}}},
        "/density/densities");
  names({{"density", {{"type", "metaballs"}, {"balls", json::array()}}}}, "/density/balls");
  names({{"density", {{"type", "sphere"}}}, {"modulations", {json::object()}}}, "/modulations/0");
  names({{"density", {{"type", "sphere"}}}, {"modulations", {nullptr}}}, "/modulations/0");
  // No modulation at all is the density itself.
  EXPECT_EQ(error_of({{"density", {{"type", "sphere"}}}, {"modulations", json::array()}}), "");
}

}  // namespace
}  // namespace morsel::geom

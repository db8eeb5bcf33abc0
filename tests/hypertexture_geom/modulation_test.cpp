// SPDX-License-Identifier: Apache-2.0
// Every modulation, alone and in sequences: bounds, derivatives, restrictions, and what they are.
#include <gtest/gtest.h>

#include "hypertexture_geom/field/noise.h"
#include "hypertexture_geom/field/registry.h"
#include "tests/hypertexture_geom/random_modulation.h"
#include "tests/hypertexture_geom/soundness.h"
#include "tests/hypertexture_geom/test_fields.h"

namespace morsel::geom {
namespace {

using nlohmann::json;
using testing::count_outside;
using testing::field_of;
using testing::FlushToZero;
using testing::RandomModulation;
using topology::Box;

std::vector<std::string> all_types() {
  std::vector<std::string> names;
  for (const ModulationEntry& m : modulations()) names.push_back(m.declaration.name);
  return names;
}

TEST(Modulations, BoundsHoldForEveryKind) {
  for (const bool flush : {false, true}) {
    const FlushToZero mode(flush);
    std::mt19937_64 random(101);
    for (const std::string& type : all_types())
      for (int n = 0; n < 6; ++n) {
        const json description = RandomModulation(random).field({type});
        const auto outside = count_outside(*field_of(description), random, 120, 16);
        EXPECT_EQ(outside.total(), 0) << outside.text() << " of " << description;
      }
  }
}

TEST(Modulations, BoundsHoldForSequences) {
  std::mt19937_64 random(102);
  const std::vector<std::string> types = all_types();
  const auto any = [&] { return types[random() % types.size()]; };
  for (int n = 0; n < 40; ++n) {
    std::vector<std::string> sequence{any(), any()};
    if (n % 2 == 1) sequence.push_back(any());
    const json description = RandomModulation(random).field(sequence);
    const auto outside = count_outside(*field_of(description), random, 60, 16);
    EXPECT_EQ(outside.total(), 0) << outside.text() << " of " << description;
  }
}

TEST(Modulations, AWeakenedBoundIsNoticed) {
  std::mt19937_64 random(103);
  for (const std::string type : {"turbulence", "ridged", "warp", "gain"}) {
    testing::Outside sum;
    for (int n = 0; n < 8; ++n) {
      const json description = RandomModulation(random).field({type, "fbm"});
      const auto outside = count_outside(*field_of(description), random, 100, 24, 0.3);
      sum.value += outside.value;
      sum.gradient += outside.gradient;
    }
    EXPECT_GT(sum.value, 0) << type;
    EXPECT_GT(sum.gradient, 0) << type;
  }
}

TEST(Modulations, HugeAndFlatBoxesSayNothingWrong) {
  std::mt19937_64 random(104);
  for (const std::string& type : all_types())
    for (int n = 0; n < 4; ++n) {
      const json description = RandomModulation(random).field({type, "bias"});
      const auto field = field_of(description);
      for (const double size : {3.0, 100.0, 1e6, 1e30, 1e150}) {
        const Imath::V3d half(size, size * 0.5, n % 2 == 0 ? size : 0.0);
        const topology::LocalModel m = field->model(Box(-half, half));
        EXPECT_TRUE(m.value_error >= 0.0 && m.hessian_error >= 0.0) << description << size;
        for (int i = 0; i < 3; ++i) EXPECT_TRUE(m.gradient_error[i] >= 0.0) << description << size;
        const topology::Interval range = m.range();
        EXPECT_FALSE(std::isnan(range.lo) || std::isnan(range.hi));
        for (int k = 0; k < 20 && size < 1e5; ++k) {
          const double s = RandomModulation(random).uniform(-1.0, 1.0);
          EXPECT_TRUE(range.contains(field->value(half * s))) << description << size;
        }
      }
    }
}

TEST(Modulations, RestrictionsGiveTheSameField) {
  std::mt19937_64 random(105);
  RandomModulation make(random);
  const std::vector<std::string> types = all_types();
  for (int n = 0; n < 60; ++n) {
    const json description = make.field({types[random() % types.size()], types[n % types.size()]});
    const auto field = field_of(description);
    const Imath::V3d c(make.uniform(-2, 2), make.uniform(-2, 2), make.uniform(-2, 2));
    const Imath::V3d size(std::ldexp(1.0, -make.integer(0, 10)));
    const auto outer = field->restricted_to(Box(c - size, c + size));
    const auto inner = outer->restricted_to(Box(c, c + size));
    for (int k = 0; k < 10; ++k) {
      const Imath::V3d x =
          c + size * Imath::V3d(make.uniform(0, 1), make.uniform(0, 1), make.uniform(0, 1));
      const double whole = field->value(x), slack = 1e-12 * (1.0 + std::abs(whole));
      EXPECT_NEAR(outer->value(x), whole, slack) << description;
      EXPECT_NEAR(inner->value(x), whole, slack) << description;
      EXPECT_NEAR(inner->jet(x).value, whole, slack) << description;
    }
  }
}

TEST(Modulations, JetsAgreeWithDifferences) {
  std::mt19937_64 random(106);
  RandomModulation make(random);
  constexpr double kStep = 1e-5;
  const std::vector<std::string> types = all_types();
  for (int n = 0; n < 100; ++n) {
    json description = make.field({types[random() % types.size()], types[n % types.size()]});
    // Sharp creases bend within a difference's step.
    for (json& m : description["modulations"])
      if (m.contains("smoothing")) m["smoothing"] = 0.3;
    const auto field = field_of(description);
    for (int k = 0; k < 4; ++k) {
      const Imath::V3d x(make.uniform(-2, 2), make.uniform(-2, 2), make.uniform(-2, 2));
      const topology::Jet jet = field->jet(x);
      double bend = 1.0;
      for (const double h : jet.hessian) bend = std::max(bend, std::abs(h));
      for (int i = 0; i < 3; ++i) {
        Imath::V3d e(0.0);
        e[i] = kStep;
        const double size = 1.0 + jet.gradient.length();
        EXPECT_NEAR(jet.gradient[i], (field->value(x + e) - field->value(x - e)) / (2.0 * kStep),
                    1e-6 * size * size * size)
            << description;
        for (int j = 0; j < 3; ++j)
          EXPECT_NEAR(
              testing::hessian_of(jet, i, j),
              (field->jet(x + e).gradient[j] - field->jet(x - e).gradient[j]) / (2.0 * kStep),
              0.02 * bend)
              << description;
      }
    }
  }
}

// The value that a modulation of the function's value alone makes of `t`.
double applied(const json& modulation, double t) {
  // The sphere's value along a ray from far away takes any value.
  const auto field =
      field_of({{"density", {{"type", "sphere"}, {"radius", 3.0}, {"smoothing", 1e-6}}},
                {"modulations", {modulation}}});
  return field->value(Imath::V3d(3.0 - t, 0.0, 0.0));
}

TEST(Modulations, BiasAndGainKeepTheirPromises) {
  for (const double b : {0.05, 0.3, 0.5, 0.7, 0.95}) {
    const json bias{{"type", "bias"}, {"bias", b}, {"from", 0.5}, {"to", 2.5}};
    EXPECT_NEAR(applied(bias, 0.5), 0.5, 1e-9);
    EXPECT_NEAR(applied(bias, 1.5), 0.5 + 2.0 * b, 1e-9);
    EXPECT_NEAR(applied(bias, 2.5), 2.5, 1e-9);
    const json gain{{"type", "gain"}, {"gain", b}, {"from", 0.5}, {"to", 2.5}};
    EXPECT_NEAR(applied(gain, 0.5), 0.5, 1e-9);
    EXPECT_NEAR(applied(gain, 1.5), 1.5, 1e-9);
    EXPECT_NEAR(applied(gain, 2.5), 2.5, 1e-9);
    EXPECT_NEAR((applied(gain, 1.5001) - applied(gain, 1.4999)) / 2e-4, -std::log2(1.0 - b), 1e-4);
    for (const json& m : {bias, gain})
      for (double t = -5.0; t < 2.9; t += 0.01) EXPECT_GT(applied(m, t + 0.01), applied(m, t));
  }
  EXPECT_NEAR(applied({{"type", "scale_offset"}, {"scale", 2.0}, {"offset", -0.25}}, 0.7), 1.15,
              1e-9);
}

TEST(Modulations, TurbulenceAndRidgesFollowTheNoise) {
  // One octave: F - D is a (sqrt(n^2 + k^2) - k), with n from the same seed by fbm.
  const json sphere{{"type", "sphere"}};
  const auto plain = field_of({{"density", sphere}});
  const json noise{{"frequency", 2.0}, {"seed", 5}};
  const auto with = [&](json m) {
    m.update(noise);
    return field_of({{"density", sphere}, {"modulations", {m}}});
  };
  const auto fbm = with({{"type", "fbm"}, {"amplitude", 1.0}});
  const auto turbulence = with({{"type", "turbulence"}, {"amplitude", 0.5}, {"smoothing", 0.2}});
  const auto ridged = with({{"type", "ridged"},
                            {"amplitude", 0.5},
                            {"smoothing", 0.2},
                            {"offset", 0.9},
                            {"squared", true}});
  for (int i = 0; i < 200; ++i) {
    const Imath::V3d x(0.013 * i, 1.0 - 0.009 * i, 0.3);
    const double d = plain->value(x), n = fbm->value(x) - d;
    const double s = std::sqrt(n * n + 0.04) - 0.2;
    EXPECT_NEAR(turbulence->value(x) - d, 0.5 * s, 1e-12);
    EXPECT_NEAR(ridged->value(x) - d, 0.5 * (0.9 - s) * (0.9 - s), 1e-12);
  }
  // Several octaves: those of fbm, each folded by itself.
  const auto two =
      with({{"type", "turbulence"}, {"amplitude", 1.0}, {"layers", 2}, {"smoothing", 1e-6}});
  const auto both = with({{"type", "fbm"}, {"amplitude", 1.0}, {"layers", 2}});
  const Imath::V3d x(0.4, -0.2, 0.9);
  const double d = plain->value(x), first = fbm->value(x) - d, second = both->value(x) - d - first;
  EXPECT_NEAR(two->value(x) - d, std::abs(first) + std::abs(second), 1e-5);
}

TEST(Modulations, MasksFadeAndCutOff) {
  json m{{"type", "fbm"}, {"amplitude", 0.5}, {"frequency", 2.0}};
  const auto full = field_of({{"density", {{"type", "sphere"}}}, {"modulations", {m}}});
  const auto plain = field_of({{"density", {{"type", "sphere"}}}});
  m["mask"] = {{"type", "height"}, {"axis", "z"}, {"from", 0.5}, {"to", -0.5}};
  const auto masked = field_of({{"density", {{"type", "sphere"}}}, {"modulations", {m}}});
  for (int i = 0; i < 50; ++i) {
    const double s = 0.02 * i;
    const Imath::V3d above(s, 0.3, 0.5 + s), below(s, 0.3, -0.5 - s), between(s, 0.3, 0.0);
    EXPECT_EQ(masked->value(above), plain->value(above));
    EXPECT_NEAR(masked->value(below), full->value(below), 1e-14);
    EXPECT_NEAR(masked->value(between), 0.5 * (plain->value(between) + full->value(between)),
                1e-14);
  }
  // Where the mask is 0 the noise doesn't widen the bounds.
  const Box box(Imath::V3d(-0.1, -0.1, 0.6), Imath::V3d(0.1, 0.1, 0.8));
  EXPECT_NEAR(masked->model(box).range().width(), plain->model(box).range().width(), 1e-12);
  m["mask"] = {{"type", "density"},
               {"density", {{"type", "sphere"}, {"radius", 0.5}}},
               {"from", 0.0},
               {"to", 0.2}};
  const auto inside = field_of({{"density", {{"type", "sphere"}}}, {"modulations", {m}}});
  EXPECT_EQ(inside->value({0.6, 0.1, 0.0}), plain->value({0.6, 0.1, 0.0}));
  EXPECT_NEAR(inside->value({0.2, 0.1, 0.0}), full->value({0.2, 0.1, 0.0}), 1e-14);
}

TEST(Modulations, WarpsMoveThePlaceOfEvaluation) {
  const json sphere{{"type", "sphere"}};
  const auto plain = field_of({{"density", sphere}});
  json m{{"type", "warp"}, {"amplitude", 0.2}, {"frequency", 2.0}, {"seed", 3}};
  const auto warped = field_of({{"density", sphere}, {"modulations", {m}}});
  NoiseDescription noise;
  noise.octaves = fbm_octaves(0.2, 2.0, 1, 2.0, 0.8);
  noise.seed = 3;
  double moved = 0.0;
  for (int i = 0; i < 50; ++i) {
    const Imath::V3d x(0.03 * i, 0.7 - 0.02 * i, 0.1);
    Imath::V3d y = x;
    for (std::uint32_t a = 0; a < 3; ++a)
      y[static_cast<int>(a)] += make_noise(noise, 0, 1, 1 + a)->value(x);
    EXPECT_NEAR(warped->value(x), plain->value(y), 1e-14);
    moved = std::max(moved, (y - x).length());
  }
  EXPECT_GT(moved, 0.1);
}

TEST(Modulations, BoundsOfTheSolidHoldIt) {
  std::mt19937_64 random(107);
  RandomModulation make(random);
  const std::vector<std::string> types = all_types();
  int bounded = 0;
  for (int n = 0; n < 80; ++n) {
    const json description = make.field({types[random() % types.size()], types[n % types.size()]});
    const auto field = field_of(description);
    const std::optional<Box> box = field->solid_bounds();
    if (!box) continue;
    ++bounded;
    for (int k = 0; k < 2000; ++k) {
      const Imath::V3d x(make.uniform(-5, 5), make.uniform(-5, 5), make.uniform(-5, 5));
      if (field->value(x) >= 0.0) {
        EXPECT_TRUE(box->intersects(x)) << description;
      }
    }
  }
  EXPECT_GT(bounded, 40);
}

// The message of the InputError that a sphere with one modulation provokes.
std::string error_of(const json& modulation) {
  try {
    field_of({{"density", {{"type", "sphere"}}}, {"modulations", {modulation}}});
  } catch (const params::InputError& e) {
    return e.what();
  }
  return "no error";
}

void expect_all(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
}

TEST(Modulations, ErrorsNamePlaceAndValue) {
  EXPECT_EQ(error_of({{"type", "turbulence"}}), "no error");
  expect_all(error_of({{"type", "turbulance"}}), {"/modulations/0/type", "did you mean"});
  expect_all(error_of({{"type", "turbulence"}, {"smoothing", 0}}),
             {"/modulations/0/smoothing", "0"});
  expect_all(error_of({{"type", "ridged"}, {"squared", 1}}),
             {"/modulations/0/squared", "true or false"});
  expect_all(error_of({{"type", "bias"}, {"bias", 1.0}}), {"/modulations/0/bias", "0.99"});
  expect_all(error_of({{"type", "gain"}, {"from", 2.0}}), {"/modulations/0/to", "2", "above"});
  expect_all(error_of({{"type", "scale_offset"}, {"scale", 0}}), {"/modulations/0/scale", "0"});
  expect_all(error_of({{"type", "warp"}, {"layers", 16}, {"lacunarity", 8}}),
             {"/modulations/0/layers", "1e9"});
  expect_all(error_of({{"type", "fbm"}, {"mask", json::object()}}),
             {"/modulations/0/mask", "type"});
  expect_all(error_of({{"type", "fbm"}, {"mask", {{"type", "hight"}}}}),
             {"/modulations/0/mask/type", "hight", "height"});
  expect_all(error_of({{"type", "fbm"}, {"mask", {{"type", "height"}, {"from", 1}}}}),
             {"/modulations/0/mask/to", "differ"});
  expect_all(error_of({{"type", "fbm"}, {"mask", {{"type", "height"}, {"axis", "w"}}}}),
             {"/modulations/0/mask/axis", "x, y, z"});
  expect_all(error_of({{"type", "fbm"}, {"mask", {{"type", "density"}}}}),
             {"/modulations/0/mask", "density"});
  expect_all(error_of({{"type", "fbm"},
                       {"mask",
                        {{"type", "density"}, {"density", {{"type", "sphere"}, {"radius", -1}}}}}}),
             {"/modulations/0/mask/density/radius", "-1"});
}

TEST(Modulations, NestedDescriptionsAreCanonical) {
  json a{{"type", "fbm"}, {"mask", {{"type", "density"}, {"density", {{"type", "sphere"}}}}}};
  json b{{"type", "fbm"},
         {"mask",
          {{"type", "density"},
           {"from", 0},
           {"density", {{"type", "sphere"}, {"radius", 1}, {"center", {0, 0, 0}}}}}}};
  const auto canonical = [](const json& m) {
    return field_of({{"density", {{"type", "sphere"}}}, {"modulations", {m}}})->canonical_json();
  };
  EXPECT_EQ(canonical(a), canonical(b));
  b["mask"]["density"]["radius"] = 0.9;
  EXPECT_NE(canonical(a), canonical(b));
  EXPECT_FALSE(canonical({{"type", "fbm"}})["modulations"][0].contains("mask"));
}

}  // namespace
}  // namespace morsel::geom

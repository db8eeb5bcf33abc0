// SPDX-License-Identifier: Apache-2.0
// The evaluators' conformance suite: every kind of field and random compositions, on boxes of every
// size, in single and double precision, in batches and single points, with every instruction set
// that this machine has, against the field's own double-precision value and jet.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <vector>

#include "hypertexture_geom/field/compiled_field.h"
#include "hypertexture_geom/field/registry.h"
#include "tests/hypertexture_geom/random_density.h"
#include "tests/hypertexture_geom/random_modulation.h"
#include "tests/hypertexture_geom/soundness.h"
#include "tests/hypertexture_geom/test_fields.h"

namespace morsel::geom {
namespace {

using nlohmann::json;
using testing::eq13_json;
using testing::field_of;
using testing::FlushToZero;
using testing::RandomModulation;
using topology::Box;

// What one evaluator got wrong, as parts of its guaranteed error; above 1 is a broken promise.
struct Worst {
  double value = 0.0, gradient = 0.0;
  double error = 0.0;  // absolute, of values
  int unbounded = 0, boxes = 0;
};

template <class T>
void compare(const topology::ScalarField& field, const Box& box, std::mt19937_64& random,
             std::size_t count, Worst& worst) {
  const CompiledField<T> compiled(field, box);
  ++worst.boxes;
  std::vector<T> x[3], value(count), only(count), gradient[3];
  const Imath::V3d half = topology::half_size(box);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int a = 0; a < 3; ++a) {
    gradient[a].resize(count);
    // Within the box after rounding, too.
    for (std::size_t i = 0; i < count; ++i)
      x[a].push_back(static_cast<T>(unit(random) * half[a] * (1.0 - 1e-6)));
  }
  const T* const p[3] = {x[0].data(), x[1].data(), x[2].data()};
  T* const g[3] = {gradient[0].data(), gradient[1].data(), gradient[2].data()};
  compiled.values(p, count, only.data());
  compiled.gradients(p, count, value.data(), g);
  const bool bounded = std::isfinite(compiled.value_error());
  if (!bounded) ++worst.unbounded;
  for (std::size_t i = 0; i < count; ++i) {
    const Imath::V3d at = compiled.centre() + Imath::V3d(x[0][i], x[1][i], x[2][i]);
    const topology::Jet jet = field.jet(at);
    Imath::Vec3<T> slope;
    const Imath::Vec3<T> single(x[0][i], x[1][i], x[2][i]);
    const T both = compiled.value_and_gradient(single, slope);
    const double slack = 2e-13 * (1.0 + std::abs(jet.value) + jet.gradient.length());
    for (const T v : {value[i], only[i], compiled.value(single), both}) {
      const double off = std::abs(static_cast<double>(v) - jet.value);
      ASSERT_FALSE(std::isnan(off));
      worst.error = std::max(worst.error, off);
      if (bounded) worst.value = std::max(worst.value, off / (compiled.value_error() + slack));
    }
    double bend = 1.0;
    for (const double h : jet.hessian) bend = std::max(bend, std::abs(h));
    for (int a = 0; a < 3; ++a)
      for (const T v : {gradient[a][i], slope[a]}) {
        const double off = std::abs(static_cast<double>(v) - jet.gradient[a]);
        if (std::isfinite(compiled.gradient_error()[a]))
          worst.gradient =
              std::max(worst.gradient, off / (compiled.gradient_error()[a] + slack * bend));
      }
  }
}

Box random_box(std::mt19937_64& random, double reach, int levels) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Imath::V3d c(reach * unit(random), reach * unit(random), reach * unit(random));
  const double width = std::ldexp(1.0, -static_cast<int>(random() % levels));
  Imath::V3d half(width, width, width);
  if (random() % 3 == 0)
    half *= Imath::V3d(std::abs(unit(random)), std::abs(unit(random)), std::abs(unit(random)));
  return Box(c - half, c + half);
}

std::vector<json> all_kinds(std::mt19937_64& random) {
  std::vector<json> fields;
  for (const std::string& d : testing::simple_densities())
    fields.push_back({{"density", testing::random_density(d, random)}});
  for (const std::string& d : testing::boolean_densities())
    fields.push_back({{"density", testing::random_density(d, random)}});
  std::vector<std::string> types;
  for (const ModulationEntry& m : modulations()) types.push_back(m.declaration.name);
  for (const std::string& type : types) {
    fields.push_back(RandomModulation(random).field({type}));
    fields.push_back(RandomModulation(random).field(
        {types[random() % types.size()], type, types[random() % types.size()]}));
  }
  fields.push_back(eq13_json(3, 1));
  fields.push_back(testing::perlin_json(3, 1));
  return fields;
}

template <class T>
void conform(const char* name) {
  for (const bool flush : {false, true}) {
    const FlushToZero mode(flush);
    std::mt19937_64 random(31);
    for (int round = 0; round < 3; ++round)
      for (const json& description : all_kinds(random)) {
        const auto field = field_of(description);
        for (int n = 0; n < 8; ++n) {
          Worst worst;
          const std::size_t count = n == 0 ? 130 : 1 + random() % 20;
          compare<T>(*field, random_box(random, 2.0, 20), random, count, worst);
          EXPECT_LE(worst.value, 1.0) << name << " " << description;
          EXPECT_LE(worst.gradient, 1.0) << name << " " << description;
        }
      }
  }
}

TEST(CompiledField, SinglePrecisionKeepsItsPromise) { conform<float>("float"); }
TEST(CompiledField, DoublePrecisionKeepsItsPromise) { conform<double>("double"); }

TEST(CompiledField, EveryInstructionSetConforms) {
  std::vector<std::int64_t> targets;
  for (std::int64_t all = hwy::SupportedTargets(); all != 0; all &= all - 1)
    targets.push_back(all & -all);
  EXPECT_FALSE(targets.empty());
  for (const std::int64_t target : targets) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    std::mt19937_64 random(32);
    for (const json& description : all_kinds(random)) {
      const auto field = field_of(description);
      for (int n = 0; n < 3; ++n) {
        Worst worst;
        const Box box = random_box(random, 1.5, 12);
        compare<float>(*field, box, random, 3 + random() % 80, worst);
        compare<double>(*field, box, random, 3 + random() % 80, worst);
        EXPECT_LE(worst.value, 1.0) << hwy::TargetName(target) << " " << description;
        EXPECT_LE(worst.gradient, 1.0) << hwy::TargetName(target) << " " << description;
      }
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

// The figures that compiled_field.h states.
TEST(CompiledField, ErrorsAreSmallOnSmallBoxes) {
  std::mt19937_64 random(33);
  for (const bool perlin : {false, true})
    for (const int layers : {1, 3}) {
      const auto field = field_of(perlin ? testing::perlin_json(layers, 1) : eq13_json(layers, 1));
      Worst single, twice;
      double stated = 0.0, stated_gradient = 0.0;
      for (int n = 0; n < 200; ++n) {
        const Imath::V3d c = random_box(random, 1.5, 1).min;
        const Box box(c, c + Imath::V3d(0.08));
        compare<float>(*field, box, random, 16, single);
        compare<double>(*field, box, random, 16, twice);
        const CompiledField<float> compiled(*field, box);
        stated = std::max(stated, compiled.value_error());
        stated_gradient = std::max(stated_gradient, compiled.gradient_error().x);
      }
      RecordProperty("float", std::to_string(single.error));
      EXPECT_EQ(single.unbounded + twice.unbounded, 0);
      EXPECT_LT(stated, 1e-4) << perlin << layers;
      EXPECT_LT(stated_gradient, 3e-3) << perlin << layers;
      EXPECT_LT(single.error, 1.5e-6) << perlin << layers;
      EXPECT_LT(twice.error, 1e-13) << perlin << layers;
      std::printf("%s, %d layers: stated %.2g and %.2g, seen %.2g; double: seen %.2g\n",
                  perlin ? "perlin" : "sparse convolution", layers, stated, stated_gradient,
                  single.error, twice.error);
    }
}

TEST(CompiledField, WholeSpaceIsEvaluatedByHashing) {
  std::mt19937_64 random(34);
  for (const json& description : {eq13_json(3, 5), testing::perlin_json(3, 5)}) {
    const auto field = field_of(description);
    Worst worst;
    compare<float>(*field, Box(Imath::V3d(-40.0), Imath::V3d(30.0)), random, 1000, worst);
    EXPECT_LE(worst.value, 1.0);
    EXPECT_LE(worst.gradient, 1.0);
    EXPECT_EQ(worst.unbounded, 0);
    EXPECT_LT(worst.error, 2e-3);
    worst = {};
    compare<double>(*field, Box(Imath::V3d(-40.0), Imath::V3d(30.0)), random, 300, worst);
    EXPECT_LT(worst.error, 1e-11);
  }
}

// A field of someone else's.
class Foreign final : public topology::ScalarField {
 public:
  explicit Foreign(std::shared_ptr<const topology::ScalarField> f) : f_(std::move(f)) {}
  double value(const Imath::V3d& x) const override { return f_->value(x); }
  topology::Jet jet(const Imath::V3d& x) const override { return f_->jet(x); }
  topology::LocalModel model(const Box& box) const override { return f_->model(box); }
  std::unique_ptr<ScalarField> restricted_to(const Box& box) const override {
    return std::make_unique<Foreign>(f_->restricted_to(box));
  }

 private:
  std::shared_ptr<const topology::ScalarField> f_;
};

TEST(CompiledField, AnyScalarFieldIsEvaluated) {
  std::mt19937_64 random(35);
  const auto f = std::make_shared<Foreign>(field_of(eq13_json(2, 5)));
  for (int n = 0; n < 50; ++n) {
    Worst worst;
    const Box box = random_box(random, 1.5, 8);
    compare<float>(*f, box, random, 1 + n, worst);
    compare<double>(*f, box, random, 1 + n, worst);
    EXPECT_LE(worst.value, 1.0);
    EXPECT_LE(worst.gradient, 1.0);
  }
}

TEST(CompiledField, ManyPartsNeedNoMoreThanTheHeap) {
  json parts = json::array();
  for (int i = 0; i < 200; ++i)
    parts.push_back({{"type", "torus"}, {"center", {0.01 * i, 0.3, -0.005 * i}}});
  const auto field = field_of({{"density", {{"type", "union"}, {"densities", parts}}}});
  std::mt19937_64 random(36);
  Worst worst;
  compare<float>(*field, Box(Imath::V3d(-1.0), Imath::V3d(1.0)), random, 100, worst);
  EXPECT_LE(worst.value, 1.0);
  EXPECT_LE(worst.gradient, 1.0);
}

TEST(CompiledField, IsCompact) {
  const auto field = field_of(eq13_json(3, 1));
  const Box box(Imath::V3d(0.7, 0.2, 0.1), Imath::V3d(0.78, 0.28, 0.18));
  const CompiledField<float> compiled(*field, box);
  EXPECT_LT(compiled.bytes(), 4000u);
}

}  // namespace
}  // namespace morsel::geom

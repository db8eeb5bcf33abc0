// SPDX-License-Identifier: Apache-2.0
// The evaluators' conformance suite: every kind of field and random compositions, on boxes of every
// size, near and far, in single and double precision, in batches and single points, with every
// instruction set that this machine has, against the independent implementation in long double.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <limits>
#include <type_traits>
#include <vector>

#include "hypertexture_geom/field/compiled_field.h"
#include "hypertexture_geom/field/registry.h"
#include "tests/hypertexture_geom/random_density.h"
#include "tests/hypertexture_geom/random_modulation.h"
#include "tests/hypertexture_geom/reference_field.h"
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

// Below this diagonal every field has its guarantee.
constexpr double kAlwaysBounded = 0.01;

// compiled_field.h: equation (13) with one and three layers, of either noise.
constexpr double kFloatStated[2] = {9e-5, 1e-4}, kFloatSlopes[2] = {9e-4, 2.6e-3};
constexpr double kDoubleStated[2] = {2e-13, 2e-13}, kDoubleSlopes[2] = {2e-12, 6e-12};
constexpr double kFloatSeen = 1e-6, kDoubleSeen = 4e-15;

// What one evaluator got wrong, as parts of its guaranteed error; above 1 is a broken promise.
struct Worst {
  double value = 0.0, gradient = 0.0;
  double error = 0.0;  // absolute, of values
  int unbounded = 0, boxes = 0;
  int exact = 0;  // slopes that are stated to be exact: those of a constant

  // A NaN is worse than anything.
  static void take(double& worst, double x) {
    if (!(x <= worst)) worst = std::isnan(x) ? std::numeric_limits<double>::infinity() : x;
  }
};

// A description, the field and its reference.
struct Subject {
  explicit Subject(json d)
      : description(std::move(d)),
        field(field_of(description)),
        reference(testing::reference_field(field->canonical_json())),
        rounds_points(description.dump().find("perlin") != std::string::npos ||
                      description.dump().find("warp") != std::string::npos) {}
  json description;
  std::shared_ptr<const Field> field;
  std::shared_ptr<const testing::ReferenceField> reference;
  // Whether the reference evaluates noises at points that it computes: products with frequencies,
  // displaced points. Impulses and points are exact, and so are their differences but for 2^-64.
  bool rounds_points;
};

// Against the reference in long double, at exactly the points that the evaluator is given. The
// slack is the reference's: its rounding, 4e-18 of 1 + |F| (4e-17 for slopes), and what 2^-64 of a
// point's coordinates does to densities, and to noises where it rounds points. `violation` adds
// that many times the stated errors to what is computed, to show that it is noticed.
template <class T>
void compare(const topology::ScalarField& field, const Subject& subject, const Box& box,
             std::mt19937_64& random, std::size_t count, Worst& worst, double violation = 0.0) {
  const testing::ReferenceField& reference = *subject.reference;
  const CompiledField<T> compiled(field, box);
  ++worst.boxes;
  std::vector<T> x[3], value(count), only(count), gradient[3];
  const Imath::V3d half = topology::half_size(box);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int a = 0; a < 3; ++a) {
    gradient[a].resize(count);
    // Within the box after rounding, too.
    // Long double's 64 bits hold the sum with the centre.
    const double grid =
        std::ldexp(1.0, std::ilogb(std::abs(compiled.centre()[a]) + half[a] + 1e-300) - 62);
    for (std::size_t i = 0; i < count; ++i) {
      const T t = static_cast<T>(unit(random) * half[a] * (1.0 - 1e-6));
      x[a].push_back(static_cast<T>(std::trunc(t / grid) * grid));
    }
  }
  const T* const p[3] = {x[0].data(), x[1].data(), x[2].data()};
  T* const g[3] = {gradient[0].data(), gradient[1].data(), gradient[2].data()};
  compiled.values(p, count, only.data());
  compiled.gradients(p, count, value.data(), g);
  const double stated = compiled.value_error();
  const Imath::V3d stated_slope = compiled.gradient_error();
  ASSERT_FALSE(std::isnan(stated) || std::isnan(stated_slope.length2()));
  const bool bounded = std::isfinite(stated) && std::isfinite(stated_slope.length2());
  if (!bounded) ++worst.unbounded;
  using Real = long double;
  for (std::size_t i = 0; i < count; ++i) {
    const Imath::V3d& c = compiled.centre();
    const testing::Dual exact =
        reference.at(Real(c.x) + x[0][i], Real(c.y) + x[1][i], Real(c.z) + x[2][i]);
    Imath::Vec3<T> slope;
    const Imath::Vec3<T> single(x[0][i], x[1][i], x[2][i]);
    const T both = compiled.value_and_gradient(single, slope);
    Real off_by_point = 0.0L, bend = 0.0L;
    for (int a = 0; a < 3; ++a) off_by_point += 0x1p-64L * (std::abs(c[a]) + half[a]);
    for (const double h : field.jet(c).hessian) bend = std::max<Real>(bend, std::abs(h));
    Real steepest = 0.0L;
    for (const Real s : exact.g) steepest = std::max(steepest, std::abs(s));
    const Real slack = 4e-18L * (1.0L + std::abs(exact.v)) + off_by_point * steepest;
    const Real loose = 4e-17L * (1.0L + steepest) +
                       off_by_point * (subject.rounds_points ? bend : std::min(bend, 1.0L));
    for (const T v : {value[i], only[i], compiled.value(single), both}) {
      const Real off = std::abs(v - exact.v + (bounded ? violation * stated : 0.0));
      Worst::take(worst.error, static_cast<double>(off));
      if (bounded) Worst::take(worst.value, static_cast<double>(off / (stated + slack)));
    }
    for (int a = 0; a < 3; ++a)
      for (const T v : {gradient[a][i], slope[a]}) {
        const Real off = std::abs(v - exact.g[a] + (bounded ? violation * stated_slope[a] : 0.0));
        if (stated_slope[a] < 1e-18) ++worst.exact;
        if (bounded)
          Worst::take(worst.gradient, static_cast<double>(off / (stated_slope[a] + loose)));
      }
  }
}

Box random_box(std::mt19937_64& random, double reach, int levels, double far = 0.0) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Imath::V3d c(reach * unit(random), reach * unit(random), reach * unit(random));
  for (int a = 0; a < 3; ++a) c[a] += random() % 2 ? far : -far;
  const double width = std::ldexp(1.0, -static_cast<int>(random() % levels));
  Imath::V3d half(width, width, width);
  if (random() % 3 == 0)
    half *= Imath::V3d(std::abs(unit(random)), std::abs(unit(random)), std::abs(unit(random)));
  return Box(c - half, c + half);
}

// The field with its density moved: noises are where they were.
json moved(json field, const Imath::V3d& to) {
  field["density"]["center"] = {to.x, to.y, to.z};
  return field;
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

// Where boxes are: about the origin, where densities are, and far away.
constexpr double kOffsets[] = {0.0, 1.0, 1e3, 1e6};

template <class T>
void conform(const char* name) {
  Worst all;
  for (const bool flush : {false, true}) {
    const FlushToZero mode(flush);
    std::mt19937_64 random(31);
    for (int round = 0; round < 2; ++round)
      for (const json& description : all_kinds(random)) {
        const Subject subject(description);
        for (int n = 0; n < 8; ++n) {
          Worst worst;
          const std::size_t count = n == 0 ? 130 : 1 + random() % 20;
          const Box box = random_box(random, 2.0, 20, n < 4 ? 0.0 : kOffsets[n - 4]);
          compare<T>(*subject.field, subject, box, random, count, worst);
          EXPECT_LE(worst.value, 1.0) << name << " " << description << topology::centre(box);
          EXPECT_LE(worst.gradient, 1.0) << name << " " << description << topology::centre(box);
          // The guarantee may be missing on wide boxes only, and in single precision where squares
          // of distances from the object exceed 10^12.
          const bool far = std::is_same_v<T, float> && n == 7;
          if (!far && (box.max - box.min).length() < kAlwaysBounded) {
            EXPECT_EQ(worst.unbounded, 0) << name << " " << description << topology::centre(box);
          }
          all.unbounded += worst.unbounded;
          ++all.boxes;
          Worst::take(all.value, worst.value);
          Worst::take(all.gradient, worst.gradient);
        }
      }
    // Noises are not small there in comparison with the density.
    for (const double far : kOffsets)
      for (json description : {eq13_json(3, 2), testing::perlin_json(3, 2)}) {
        const Subject subject(moved(description, Imath::V3d(far, -far, far)));
        for (int n = 0; n < 20; ++n) {
          Worst worst;
          Box box = random_box(random, 1.5, 20);
          box.min += Imath::V3d(far, -far, far);
          box.max += Imath::V3d(far, -far, far);
          compare<T>(*subject.field, subject, box, random, 20, worst);
          EXPECT_LE(worst.value, 1.0) << name << " " << subject.description;
          EXPECT_LE(worst.gradient, 1.0) << name << " " << subject.description;
          Worst::take(all.value, worst.value);
          Worst::take(all.gradient, worst.gradient);
        }
      }
  }
  std::printf(
      "%s: errors are at most %.2g (values) and %.2g (slopes) of those stated; none are "
      "stated on %d of %d boxes\n",
      name, all.value, all.gradient, all.unbounded, all.boxes);
}

TEST(CompiledField, SinglePrecisionKeepsItsPromise) { conform<float>("float"); }
TEST(CompiledField, DoublePrecisionKeepsItsPromise) { conform<double>("double"); }

// Results that are off by twice the stated error fail the comparison, at any distance: the
// reference's slack hides nothing.
TEST(CompiledField, BrokenPromisesAreNoticed) {
  std::mt19937_64 random(37);
  int noticed = 0;
  for (const json& description : all_kinds(random))
    for (const double far : kOffsets) {
      const Subject subject(description);
      for (int n = 0; n < 3; ++n) {
        Worst single, twice;
        const Box box = random_box(random, 2.0, 12, far);
        compare<float>(*subject.field, subject, box, random, 3, single, 2.0);
        compare<double>(*subject.field, subject, box, random, 3, twice, 2.0);
        for (const Worst& w : {single, twice}) {
          if (w.unbounded != 0) continue;
          EXPECT_GT(w.value, 1.0) << description << far;
          if (w.exact == 0) {
            EXPECT_GT(w.gradient, 1.0) << description << far;
          }
          ++noticed;
        }
      }
    }
  EXPECT_GT(noticed, 500);
}

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
      const Subject subject(description);
      for (int n = 0; n < 3; ++n) {
        Worst worst;
        const Box box = random_box(random, 1.5, 12);
        compare<float>(*subject.field, subject, box, random, 3 + random() % 40, worst);
        compare<double>(*subject.field, subject, box, random, 3 + random() % 40, worst);
        EXPECT_LE(worst.value, 1.0) << hwy::TargetName(target) << " " << description;
        EXPECT_LE(worst.gradient, 1.0) << hwy::TargetName(target) << " " << description;
      }
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

// The figures that compiled_field.h states, on boxes as wide as the radius of the finest kernel, or
// as Perlin's lattice of that frequency; printed by this test.
template <class T>
void print_figures(const char* precision, double far) {
  std::mt19937_64 random(33);
  for (const bool perlin : {false, true})
    for (const int layers : {1, 3}) {
      const Imath::V3d shift(far, -far, far);
      const Subject subject(
          moved(perlin ? testing::perlin_json(layers, 1) : eq13_json(layers, 1), shift));
      const double side = 1.0 / (3.0 * (1 << (layers - 1)));
      Worst worst;
      double stated = 0.0, stated_gradient = 0.0;
      for (int n = 0; n < 100; ++n) {
        const Imath::V3d c = random_box(random, 1.5, 1).min + shift;
        const Box box(c, c + Imath::V3d(side));
        compare<T>(*subject.field, subject, box, random, 16, worst);
        const CompiledField<T> compiled(*subject.field, box);
        stated = std::max(stated, compiled.value_error());
        stated_gradient = std::max(stated_gradient, compiled.gradient_error().x);
      }
      EXPECT_EQ(worst.unbounded, 0);
      EXPECT_LE(worst.value, 1.0);
      EXPECT_LE(worst.gradient, 1.0);
      std::printf("%-6s at %-5.0g %-18s %d layers: stated %8.2g, gradient %8.2g; seen %8.2g\n",
                  precision, far, perlin ? "perlin" : "sparse convolution", layers, stated,
                  stated_gradient, worst.error);
      if (far != 0.0) continue;
      constexpr bool kSingle = std::is_same_v<T, float>;
      EXPECT_LT(stated, kSingle ? kFloatStated[layers / 2] : kDoubleStated[layers / 2]);
      EXPECT_LT(stated_gradient, kSingle ? kFloatSlopes[layers / 2] : kDoubleSlopes[layers / 2]);
      EXPECT_LT(worst.error, kSingle ? kFloatSeen : kDoubleSeen);
    }
}

TEST(CompiledField, ErrorsAreSmallOnSmallBoxes) {
  for (const double far : {0.0, 1e3, 1e6}) {
    print_figures<float>("float", far);
    print_figures<double>("double", far);
  }
}

TEST(CompiledField, WholeSpaceIsEvaluatedByHashing) {
  std::mt19937_64 random(34);
  for (const json& description : {eq13_json(3, 5), testing::perlin_json(3, 5)}) {
    const Subject subject(description);
    const Box box(Imath::V3d(-40.0), Imath::V3d(30.0));
    Worst worst;
    compare<float>(*subject.field, subject, box, random, 1000, worst);
    EXPECT_LE(worst.value, 1.0);
    EXPECT_LE(worst.gradient, 1.0);
    EXPECT_EQ(worst.unbounded, 0);
    EXPECT_LT(worst.error, 2e-3);
    worst = {};
    compare<double>(*subject.field, subject, box, random, 300, worst);
    EXPECT_LE(worst.value, 1.0);
    EXPECT_LE(worst.gradient, 1.0);
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
  const Subject subject(eq13_json(2, 5));
  const auto f = std::make_shared<Foreign>(subject.field);
  for (int n = 0; n < 50; ++n) {
    Worst worst;
    const Box box = random_box(random, 1.5, 8, n % 2 ? 0.0 : 1e3);
    compare<float>(*f, subject, box, random, 1 + n, worst);
    compare<double>(*f, subject, box, random, 1 + n, worst);
    EXPECT_LE(worst.value, 1.0);
    EXPECT_LE(worst.gradient, 1.0);
  }
}

TEST(CompiledField, ManyPartsNeedNoMoreThanTheHeap) {
  json parts = json::array();
  for (int i = 0; i < 200; ++i)
    parts.push_back({{"type", "torus"}, {"center", {0.01 * i, 0.3, -0.005 * i}}});
  const Subject subject(json{{"density", {{"type", "union"}, {"densities", parts}}}});
  std::mt19937_64 random(36);
  Worst worst;
  compare<float>(*subject.field, subject, Box(Imath::V3d(-1.0), Imath::V3d(1.0)), random, 100,
                 worst);
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

// SPDX-License-Identifier: Apache-2.0
// Local models against an independent implementation of all fields in long double; the slow test
// does the same with 10^7 samples.
#include <gtest/gtest.h>

#include <random>

#include "tests/hypertexture_geom/against_reference.h"
#include "tests/hypertexture_geom/random_density.h"
#include "tests/hypertexture_geom/random_modulation.h"
#include "tests/hypertexture_geom/reference_field.h"
#include "tests/hypertexture_geom/test_fields.h"

namespace morsel::geom::testing {
namespace {

TEST(Soundness, BoundsHoldInLongDouble) {
  for (const bool flush : {false, true}) {
    const ReferenceCheck check = check_against_reference(100'000, flush ? 11 : 12, flush);
    EXPECT_EQ(check.total(), 0) << check.text();
    EXPECT_LT(check.without_slopes, check.boxes / 20);
    EXPECT_GT(check.child_boxes, check.boxes / 4);
  }
}

TEST(Soundness, WeakenedBoundsAreNoticed) {
  const ReferenceCheck check = check_against_reference(50'000, 13, false, 0.5);
  EXPECT_GT(check.value, 100);
  EXPECT_GT(check.gradient, 100);
}

TEST(Soundness, TheReferenceIsTheSameField) {
  std::mt19937_64 random(14);
  RandomModulation make(random);
  std::vector<nlohmann::json> fields;
  for (const auto* names : {&simple_densities(), &boolean_densities()})
    for (const std::string& name : *names)
      fields.push_back({{"density", random_density(name, random)}});
  for (const std::string type :
       {"fbm", "turbulence", "ridged", "bias", "gain", "scale_offset", "warp"})
    for (int n = 0; n < 6; ++n) fields.push_back(make.field({type, "fbm"}));
  for (const nlohmann::json& description : fields) {
    const auto field = field_of(description);
    const auto reference = reference_field(field->canonical_json());
    for (int n = 0; n < 50; ++n) {
      const Imath::V3d x(make.uniform(-2, 2), make.uniform(-2, 2), make.uniform(-2, 2));
      const Dual expected = reference->at(x.x, x.y, x.z);
      const topology::Jet jet = field->jet(x);
      const double slack = 1e-13 * (1.0 + std::abs(jet.value));
      EXPECT_NEAR(field->value(x), static_cast<double>(expected.v), slack) << description;
      EXPECT_NEAR(jet.value, static_cast<double>(expected.v), slack) << description;
      double bend = 1.0;
      for (const double h : jet.hessian) bend = std::max(bend, std::abs(h));
      for (int a = 0; a < 3; ++a) {
        EXPECT_NEAR(jet.gradient[a], static_cast<double>(expected.g[a]), 1e-13 * bend)
            << description;
        // The reference's own derivatives: differences in long double.
        constexpr long double kStep = 1e-7L;
        long double ends[2];
        for (int side = 0; side < 2; ++side) {
          long double y[3] = {x.x, x.y, x.z};
          y[a] += side == 0 ? -kStep : kStep;
          ends[side] = reference->at(y[0], y[1], y[2]).v;
        }
        EXPECT_NEAR(static_cast<double>((ends[1] - ends[0]) / (2.0L * kStep)),
                    static_cast<double>(expected.g[a]), 1e-9 * bend * bend)
            << description;
      }
    }
  }
}

}  // namespace
}  // namespace morsel::geom::testing

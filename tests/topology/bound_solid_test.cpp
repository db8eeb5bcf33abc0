// SPDX-License-Identifier: Apache-2.0
// The box that is derived from a field.
#include "topology/bound_solid.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "tests/hypertexture_geom/test_fields.h"
#include "tests/topology/counted_field.h"
#include "topology/verify.h"

namespace morsel::topology {
namespace {

using testing::Counted;

Box cube(double half) { return {Imath::V3d(-half), Imath::V3d(half)}; }

// Derived bounds are proved free of solid, whatever the faces of the octree's cells show.
TEST(BoundSolid, PlainDensitiesDoNotTouchDerivedBounds) {
  for (const nlohmann::json& density : std::vector<nlohmann::json>{
           {{"type", "capsule"}, {"start", {-1, 0, 0}}, {"end", {1, 0, 0}}, {"radius", 0.5}},
           {{"type", "rounded_box"}, {"half_size", {1, 0.7, 0.5}}, {"rounding", 0.2}},
           {{"type", "torus"}, {"axis", {0, 1, 0}}, {"major_radius", 1}, {"minor_radius", 0.3}}}) {
    const auto field = geom::testing::field_of({{"density", density}});
    CertifyOptions options;
    options.box = find_solid(*field, *field->solid_bounds());
    const Topology t = certify(*field, options);
    EXPECT_FALSE(t.touches_box.has_value()) << density;
    EXPECT_EQ(t.components.size(), 1u) << density;
    const VerifyReport report = verify(*field, t, {});
    EXPECT_TRUE(report.passed()) << (report.failures.empty() ? "" : report.failures[0]);
  }
}

// The box of a field of many layers takes long: cancelling is heard at once, in the grids that come
// first and in the proofs of its faces.
TEST(BoundSolid, EndsCleanlyInTheMiddleOfTheWork) {
  const std::shared_ptr<const ScalarField> field =
      geom::testing::field_of(geom::testing::eq13_json(1, 3));
  constexpr int kMany = 1 << 30;
  Counted::Trigger all{kMany, [] {}};
  Box alone, together;
  tbb::task_arena one(1), four(4);
  one.execute([&] { alone = find_solid(Counted(field, all), cube(4.0)); });
  four.execute([&] { together = find_solid(*field, cube(4.0)); });
  EXPECT_EQ(alone, together);
  const int models = kMany - all.count;
  ASSERT_GT(models, 1000);
  for (const int count : {1, 100, models / 2, models - 20}) {
    std::atomic<bool> cancel{false};
    Execution execution;
    execution.cancel = &cancel;
    Counted::Trigger stop{count, [&] { cancel = true; }};
    one.execute([&] {
      EXPECT_THROW(find_solid(Counted(field, stop), cube(4.0), execution), Cancelled) << count;
    });
    EXPECT_EQ(stop.count, 0) << "models after the cancellation at " << count;
  }
  const std::atomic<bool> cancel{true};
  Execution execution;
  execution.cancel = &cancel;
  Counted::Trigger before{kMany, [] {}};
  EXPECT_THROW(find_solid(Counted(field, before), cube(4.0), execution), Cancelled);
  EXPECT_EQ(before.count, kMany);
  EXPECT_THROW(place_where_cut(Counted(field, before), cube(2.0), execution), Cancelled);
}

}  // namespace
}  // namespace morsel::topology

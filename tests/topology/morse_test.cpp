// SPDX-License-Identifier: Apache-2.0
// The paper's engine against closed forms.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cmath>
#include <memory>
#include <numbers>

#include "tests/hypertexture_geom/test_fields.h"
#include "tests/topology/blobs.h"
#include "tests/topology/counted_field.h"
#include "topology/morse/classify.h"
#include "topology/morse/membership.h"
#include "topology/morse/morse_complex.h"
#include "topology/morse/perturbed_field.h"
#include "topology/morse/subdivision.h"
#include "topology/morse/zero.h"

namespace morsel::topology {
namespace {

using testing::Blobs;
using testing::Constant;
using testing::two_blobs;

Box cube(double half, const Imath::V3d& centre = Imath::V3d(0.0)) {
  return {centre - Imath::V3d(half), centre + Imath::V3d(half)};
}

MorseComplex complex_of(const ScalarField& field, const Box& box) {
  MorseOptions options;
  options.box = box;
  return morse_complex(field, options);
}

// Counts as (maxima, 2-saddles, 1-saddles, minima).
std::array<std::uint64_t, 4> counts(const MorseComplex& c) {
  return {c.count(CriticalType::kMaximum), c.count(CriticalType::kSaddle2),
          c.count(CriticalType::kSaddle1), c.count(CriticalType::kMinimum)};
}
using Counts = std::array<std::uint64_t, 4>;

std::int64_t euler(const MorseComplex& c) {
  std::int64_t sum = 0;
  for (const MorseSet& s : c.sets) sum += s.euler();
  return sum;
}

TEST(Morse, OneSphere) {
  const auto field = geom::testing::field_of({{"density", {{"type", "sphere"}, {"radius", 1.0}}}});
  // The maximum in a cell, on a wall, an edge and the corner that eight cells share.
  for (const Imath::V3d& shift : {Imath::V3d(0.0), Imath::V3d(0.3, 0.0, 0.0),
                                  Imath::V3d(0.3, 0.4, 0.0), Imath::V3d(0.3, 0.4, 0.56)}) {
    const MorseComplex c = complex_of(*field, cube(2.0, shift));
    EXPECT_TRUE(c.resolved());
    EXPECT_EQ(counts(c), (Counts{1, 0, 0, 0}));
    ASSERT_EQ(c.sets.size(), 1u);
    EXPECT_LT(c.points[0].position.length(), 1e-11);
    EXPECT_GT(c.points[0].basin, 0.001);
    EXPECT_EQ(c.main, 0u);
  }
}

TEST(Morse, TwoBlobsJustJoinedAndJustApart) {
  for (const Imath::V3d& direction :
       {Imath::V3d(1, 0, 0), Imath::V3d(0.3, 0.5, 0.8), Imath::V3d(1, 1, 1)}) {
    for (const Imath::V3d& shift : {Imath::V3d(0.0), Imath::V3d(0.1234, -0.0567, 0.0891)}) {
      for (const double size : {1e-1, 1e-3, 1e-6, 1e-9}) {
        const MorseComplex joined = complex_of(two_blobs(size, direction, shift), cube(2.4));
        EXPECT_TRUE(joined.resolved());
        EXPECT_EQ(counts(joined), (Counts{2, 1, 0, 0}));
        ASSERT_EQ(joined.sets.size(), 1u);
        EXPECT_EQ(joined.sets[0].euler(), 1);
        EXPECT_NEAR(joined.points[2].value, size, 1e-13);
        EXPECT_LT((joined.points[2].position - shift).length(), 1e-11);
        EXPECT_NEAR(std::abs(joined.points[2].axis.dot(direction.normalized())), 1.0, 1e-12);
        const MorseComplex apart = complex_of(two_blobs(-size, direction, shift), cube(2.4));
        EXPECT_TRUE(apart.resolved());
        EXPECT_EQ(counts(apart), (Counts{2, 0, 0, 0}));
        EXPECT_EQ(apart.sets.size(), 2u);
      }
    }
  }
}

TEST(Morse, ASaddleOnTheSurfaceIsReportedNotGuessed) {
  const MorseComplex c = complex_of(two_blobs(0.0, {0.3, 0.5, 0.8}, {0.01, 0.02, 0.03}), cube(2.4));
  EXPECT_FALSE(c.resolved());
  ASSERT_FALSE(c.places.empty());
  EXPECT_LT((centre(c.places[0].box) - Imath::V3d(0.01, 0.02, 0.03)).length(), 1e-6);
}

TEST(Morse, ChainsAndRings) {
  for (const std::uint64_t count : {2u, 3u, 7u}) {
    std::vector<Imath::V3d> apart, joined;
    for (std::uint64_t i = 0; i < count; ++i) {
      apart.emplace_back(2.5 * i, 0.1 * i, 0.0);
      joined.emplace_back(1.0 * i, 0.1 * i, 0.0);
    }
    const MorseComplex a = complex_of(Blobs(apart, 1.0, 0.3), cube(20.0));
    EXPECT_EQ(counts(a), (Counts{count, 0, 0, 0}));
    EXPECT_EQ(a.sets.size(), count);
    const MorseComplex j = complex_of(Blobs(joined, 1.0, 0.3), cube(20.0));
    EXPECT_EQ(counts(j), (Counts{count, count - 1, 0, 0}));
    ASSERT_EQ(j.sets.size(), 1u);
    EXPECT_EQ(j.sets[0].maxima, count);
  }
  std::vector<Imath::V3d> ring;
  for (int i = 0; i < 12; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 12.0;
    ring.emplace_back(2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.0);
  }
  const MorseComplex r = complex_of(Blobs(ring, 1.0, 0.3), cube(4.0));
  EXPECT_TRUE(r.resolved());
  EXPECT_EQ(counts(r), (Counts{12, 12, 0, 0}));  // one handle
  ASSERT_EQ(r.sets.size(), 1u);
  EXPECT_EQ(r.sets[0].euler(), 0);
}

// Blobs at the corners of an icosahedron, joined along its edges and over its faces.
Blobs icosahedron(double radius, double level) {
  const double g = std::numbers::phi, scale = 1.0 / std::sqrt(1.0 + g * g);
  std::vector<Imath::V3d> corners;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-g, g}) {
      corners.push_back(Imath::V3d(0.0, a, b) * scale);
      corners.push_back(Imath::V3d(a, b, 0.0) * scale);
      corners.push_back(Imath::V3d(b, 0.0, a) * scale);
    }
  return {corners, radius, level};
}

TEST(Morse, AShellHasACavity) {
  const MorseComplex hollow = complex_of(icosahedron(0.95, 0.3), cube(2.1));
  EXPECT_TRUE(hollow.resolved());
  EXPECT_EQ(counts(hollow), (Counts{12, 30, 20, 0}));
  ASSERT_EQ(hollow.sets.size(), 1u);
  EXPECT_EQ(hollow.sets[0].euler(), 2);
  // With wider blobs the middle is solid, and F has a minimum there.
  const MorseComplex solid = complex_of(icosahedron(1.1, 0.03), cube(2.1, {0.01, 0.0, 0.0}));
  EXPECT_TRUE(solid.resolved());
  EXPECT_EQ(solid.count(CriticalType::kMinimum), 1u);
  ASSERT_EQ(solid.sets.size(), 1u);
  EXPECT_EQ(solid.sets[0].minima, 1u);
  EXPECT_EQ(solid.sets[0].euler(), 1);
}

TEST(Morse, APatchOfATriplyPeriodicLattice) {
  constexpr int kSide = 3;
  constexpr double kSpacing = 1.1;
  std::vector<Imath::V3d> centres;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j)
      for (int k = 0; k < kSide; ++k) centres.push_back(Imath::V3d(i, j, k) * kSpacing);
  const Box box = cube(2.3, Imath::V3d(0.5 * (kSide - 1) * kSpacing));
  // By level: struts only; struts and walls; all solid.
  const struct {
    double level;
    Counts counts;
  } cases[] = {{0.3, {27, 54, 0, 0}}, {0.1, {27, 54, 36, 0}}, {0.005, {27, 54, 36, 8}}};
  for (const auto& expected : cases) {
    const MorseComplex c = complex_of(Blobs(centres, 1.0, expected.level), box);
    EXPECT_TRUE(c.resolved());
    EXPECT_EQ(counts(c), expected.counts);
    EXPECT_EQ(c.sets.size(), 1u);
    const Counts& n = expected.counts;
    EXPECT_EQ(euler(c),
              static_cast<std::int64_t>(n[0] + n[2]) - static_cast<std::int64_t>(n[1] + n[3]));
  }
}

TEST(Morse, PlateausAreRefused) {
  EXPECT_THROW(complex_of(Constant(1.0), cube(1.0)), NotIsolated);
  EXPECT_TRUE(complex_of(Constant(-1.0), cube(1.0)).points.empty());
}

// The middle circle of a torus is a curve of critical points; a perturbation leaves a maximum and a
// 2-saddle of it.
TEST(Morse, ATorusNeedsAPerturbation) {
  const auto field = geom::testing::field_of(
      {{"density",
        {{"type", "torus"}, {"major_radius", 1.0}, {"minor_radius", 0.4}, {"smoothing", 0.1}}}});
  EXPECT_THROW(complex_of(*field, cube(2.0)), NotIsolated);
  MorseOptions options;
  options.box = cube(2.0);
  options.perturbation = 1e-2;
  const MorseComplex c = morse_complex(*field, options);
  EXPECT_TRUE(c.resolved());
  EXPECT_EQ(counts(c), (Counts{1, 1, 0, 0}));
  ASSERT_EQ(c.sets.size(), 1u);
  EXPECT_EQ(c.sets[0].euler(), 0);
  const PerturbedField tilted = perturbed(*field, options.box, 1e-2);
  for (const CriticalPoint& p : c.points) {
    EXPECT_LT(tilted.jet(p.position).gradient.length(), 1e-9);
    EXPECT_NEAR(p.value, field->value(p.position), 1e-2);
  }
  options.perturbation = -1.0;
  EXPECT_THROW(morse_complex(*field, options), std::invalid_argument);
}

TEST(Morse, DoesNotDependOnThreads) {
  const auto field = geom::testing::field_of(geom::testing::eq13_json(1, 3, 0.8, 2.0));
  MorseComplex one, two;
  tbb::task_arena(1).execute([&] { one = complex_of(*field, cube(3.5)); });
  tbb::task_arena(2).execute([&] { two = complex_of(*field, cube(3.5)); });
  ASSERT_EQ(one.points.size(), two.points.size());
  EXPECT_GT(one.points.size(), 50u);
  for (std::size_t i = 0; i < one.points.size(); ++i) {
    EXPECT_EQ(one.points[i].position, two.points[i].position);
    EXPECT_EQ(one.points[i].set, two.points[i].set);
  }
  EXPECT_EQ(one.boxes, two.boxes);
}

// Every zero is one: by the field's own jets, by sampling Newton's iteration from everywhere, and
// the positions don't depend on how the box lies.
TEST(Morse, FindsWhatNewtonFindsFromEverywhere) {
  const auto field = geom::testing::field_of(geom::testing::eq13_json(1, 5, 0.8, 2.0));
  const Box box = cube(1.0);
  const MorseComplex c = complex_of(*field, box);  // it cuts the solid: ascents may leave it
  EXPECT_EQ(c.unresolved_boxes, 0u);
  for (const CriticalPoint& p : c.points) {
    const Jet jet = field->jet(p.position);
    EXPECT_LT(jet.gradient.length(), 1e-9);
    EXPECT_GT(jet.value, 0.0);
    EXPECT_LT(p.radius, 1e-9);
  }
  std::size_t found = 0;
  std::vector<bool> seen(c.points.size(), false);
  constexpr int kSide = 16;
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    const Imath::V3d x =
        box.min + Imath::V3d(i % kSide + 0.5, i / kSide % kSide + 0.5, i / kSide / kSide + 0.5) *
                      (2.0 / kSide);
    const auto end = newton(*field, x, box, 40);
    if (!end || field->value(*end) <= 0.0 || field->jet(*end).gradient.length() > 1e-8) continue;
    bool known = false;
    for (std::size_t n = 0; n < c.points.size(); ++n) {
      if ((c.points[n].position - *end).length() > 1e-6) continue;
      known = true;
      found += !seen[n];
      seen[n] = true;
    }
    EXPECT_TRUE(known) << *end;
  }
  EXPECT_GT(found, c.points.size() * 3 / 4);
}

// Relaxation from seeds changes the way and not the answer, whatever the seeds are.
TEST(Morse, SeedsDoNotChangeWhatIsFound) {
  const auto field = geom::testing::field_of(geom::testing::eq13_json(1, 5, 0.8, 2.0));
  SubdivisionOptions options;
  options.box = cube(1.0);
  const CriticalPoints plain = find_critical_points(*field, options);
  EXPECT_EQ(plain.from_seeds, 0u);
  for (int i = 0; i < 7 * 7 * 7; ++i)
    options.seeds.push_back(Imath::V3d(i % 7 - 3, i / 7 % 7 - 3, i / 49 - 3) / 3.3);
  options.seeds.push_back(options.seeds[0]);
  options.seeds.emplace_back(50.0, 0.0, 0.0);
  options.seeds.emplace_back(std::nan(""), 0.0, 0.0);
  options.seeds.emplace_back(0.0, HUGE_VAL, 0.0);
  const CriticalPoints seeded = find_critical_points(*field, options);
  EXPECT_GT(seeded.from_seeds, 5u);
  EXPECT_EQ(seeded.unresolved, 0u);
  ASSERT_EQ(seeded.points.size(), plain.points.size());
  for (const CriticalPoint& p : plain.points) {
    int same = 0;
    for (const CriticalPoint& q : seeded.points)
      same += (p.position - q.position).length() < 1e-10 && p.type == q.type;
    EXPECT_EQ(same, 1) << p.position;
  }
}

TEST(Morse, MembershipByStreamline) {
  std::vector<Imath::V3d> centres{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {6, 0, 0}};
  const Blobs field(centres, 1.0, 0.3);
  const Box box = cube(8.0);
  const MorseComplex c = complex_of(field, box);
  ASSERT_EQ(c.sets.size(), 2u);
  const StreamlineMembership membership(field, box, c.points);
  const auto chain = membership.set_of({0.2, 0.3, 0.1});
  ASSERT_TRUE(chain.has_value());
  EXPECT_EQ(chain, membership.set_of({2.3, -0.2, 0.1}));
  EXPECT_EQ(c.main, *chain);
  const auto single = membership.set_of({6.2, 0.3, 0.1});
  ASSERT_TRUE(single.has_value());
  EXPECT_NE(chain, single);
}

TEST(Classify, SignsOfEigenvalues) {
  const auto type = [](double a, double b, double c, double error) {
    LocalModel m;
    m.half = Imath::V3d(0.1);
    m.c[monomial::kXX] = a / 2.0;
    m.c[monomial::kYY] = b / 2.0;
    m.c[monomial::kZZ] = c / 2.0;
    m.hessian_error = error;
    return certified_type(m);
  };
  EXPECT_EQ(type(-1, -2, -3, 0.1), CriticalType::kMaximum);
  EXPECT_EQ(type(-1, 2, -3, 0.1), CriticalType::kSaddle2);
  EXPECT_EQ(type(1, 2, -3, 0.1), CriticalType::kSaddle1);
  EXPECT_EQ(type(1, 2, 3, 0.1), CriticalType::kMinimum);
  EXPECT_EQ(type(1e-3, 2, 3, 0.1), CriticalType::kDegenerate);
}

// Also within one subtree of the subdivision, which can be most of the work.
TEST(Morse, CancelsDeepInTheSubdivision) {
  std::atomic<bool> cancel{false};
  Execution execution;
  execution.cancel = &cancel;
  SubdivisionOptions options;
  options.box = {Imath::V3d(0.0), Imath::V3d(1.0)};
  options.max_depth = 12;
  options.max_unresolved = 100'000;
  testing::Counted::Trigger stop{20'000, [&] { cancel = true; }};
  const auto flat = std::make_shared<Constant>(0.0);
  tbb::task_arena(1).execute([&] {
    EXPECT_THROW(find_critical_points(testing::Counted(flat, stop), options, execution), Cancelled);
  });
  EXPECT_EQ(stop.count, 0);
}

}  // namespace
}  // namespace morsel::topology

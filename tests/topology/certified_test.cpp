// SPDX-License-Identifier: Apache-2.0
// Certified labelling against closed forms, adversarial cases and an independent slow count.
#include "topology/certified.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <memory>
#include <new>
#include <numbers>

#include "tests/hypertexture_geom/test_fields.h"
#include "tests/topology/blobs.h"
#include "tests/topology/counted_field.h"
#include "tests/topology/flood_fill.h"
#include "topology/bound_solid.h"
#include "topology/verify.h"

namespace morsel::topology {
namespace {

using testing::Blobs;
using testing::Constant;
using testing::Counted;
using testing::flood_fill;
using testing::Linear;

Box cube(double half, const Imath::V3d& centre = Imath::V3d(0.0)) {
  return {centre - Imath::V3d(half), centre + Imath::V3d(half)};
}

Topology certify_in(const ScalarField& field, const Box& box,
                    int max_depth = CertifyOptions{}.max_depth) {
  CertifyOptions options;
  options.box = box;
  options.max_depth = max_depth;
  return certify(field, options);
}

TEST(Certified, ConstantFields) {
  const Topology empty = certify_in(Constant(-1.0), cube(1.0));
  EXPECT_TRUE(empty.certified);
  EXPECT_EQ(empty.components.size(), 0u);
  EXPECT_EQ(empty.leaves, 1u);
  const Topology full = certify_in(Constant(1.0), cube(1.0));
  EXPECT_TRUE(full.certified);
  EXPECT_EQ(full.components.size(), 1u);
  EXPECT_TRUE(full.touches_box.has_value());
  EXPECT_DOUBLE_EQ(full.components[0].volume_lo, 8.0);
  // F = 0 everywhere is solid everywhere, but rounding cannot tell.
  const Topology zero = certify_in(Constant(0.0), cube(1.0), 3);
  EXPECT_FALSE(zero.certified);
  EXPECT_EQ(zero.components_lo, 0u);
  EXPECT_GT(zero.unresolved_cells, 0u);
  EXPECT_FALSE(zero.components_hi.has_value());
}

TEST(Certified, SphereVolumeIsEnclosed) {
  const auto field = geom::testing::field_of({{"density", {{"type", "sphere"}, {"radius", 1.0}}}});
  const Topology t = certify_in(*field, cube(1.3), 12);
  EXPECT_TRUE(t.certified);
  ASSERT_EQ(t.components.size(), 1u);
  const double volume = 4.0 / 3.0 * std::numbers::pi * std::pow(1.0 - 1e-4, 1.5);
  EXPECT_LT(t.components[0].volume_lo, volume);
  EXPECT_GT(t.components[0].volume_hi, volume);
  EXPECT_FALSE(t.touches_box.has_value());
}

// Two blobs of radius 1 at distance d: F on the axis between them is least half way, where it is
// 2 (1 - d^2/4)^3 - level. Place d so that this is `saddle`.
Blobs two_blobs(double saddle, const Imath::V3d& direction, const Imath::V3d& shift) {
  const double level = 0.3;
  const double d = 2.0 * std::sqrt(1.0 - std::cbrt((level + saddle) / 2.0));
  const Imath::V3d offset = direction.normalized() * (d / 2.0);
  return Blobs({shift + offset, shift - offset}, 1.0, level);
}

TEST(Certified, GapsAndBridgesDownToAHundredMillionth) {
  const Imath::V3d directions[] = {{1, 0, 0}, {0.3, 0.5, 0.8}, {1, 1, 1}};
  for (const Imath::V3d& direction : directions) {
    for (const Imath::V3d& shift : {Imath::V3d(0.0), Imath::V3d(0.1234, -0.0567, 0.0891)}) {
      for (int digits = 1; digits <= 8; ++digits) {
        const double size = std::pow(10.0, -digits);
        const Topology gap = certify_in(two_blobs(-size, direction, shift), cube(2.4));
        EXPECT_TRUE(gap.certified) << digits;
        EXPECT_EQ(gap.components.size(), 2u) << digits;
        const Topology bridge = certify_in(two_blobs(size, direction, shift), cube(2.4));
        EXPECT_TRUE(bridge.certified) << digits;
        EXPECT_EQ(bridge.components.size(), 1u) << digits;
      }
    }
  }
}

TEST(Certified, TouchingBlobsAreReportedNotGuessed) {
  const Topology t = certify_in(two_blobs(0.0, {0.3, 0.5, 0.8}, {0.01, 0.02, 0.03}), cube(2.4));
  EXPECT_FALSE(t.certified);
  EXPECT_GT(t.unresolved_cells + t.unresolved_faces, 0u);
  EXPECT_FALSE(t.unresolved.empty());
  EXPECT_LE(t.components_lo, 1u);
  ASSERT_TRUE(t.components_hi.has_value());
  EXPECT_GE(*t.components_hi, 2u);
}

TEST(Certified, ADepthLimitThatIsTooShallowIsReported) {
  for (int depth = 1; depth <= 6; ++depth) {
    const Topology t =
        certify_in(two_blobs(-1e-3, {1, 1, 0}, {0.0, 0.1, 0.2}), cube(2.4), std::max(3, depth));
    EXPECT_LE(t.components_lo, 2u);
    if (t.components_hi) {
      EXPECT_GE(*t.components_hi, 2u);
    }
    if (t.certified) {
      EXPECT_EQ(t.components.size(), 2u);
    }
  }
}

TEST(Certified, ChainsAndRings) {
  for (const int count : {2, 3, 7}) {
    std::vector<Imath::V3d> apart, joined;
    for (int i = 0; i < count; ++i) {
      apart.emplace_back(2.5 * i, 0.1 * i, 0.0);
      joined.emplace_back(1.0 * i, 0.1 * i, 0.0);
    }
    EXPECT_EQ(certify_in(Blobs(apart, 1.0, 0.3), cube(20.0)).components.size(),
              static_cast<std::size_t>(count));
    EXPECT_EQ(certify_in(Blobs(joined, 1.0, 0.3), cube(20.0)).components.size(), 1u);
  }
  std::vector<Imath::V3d> ring;
  for (int i = 0; i < 12; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 12.0;
    ring.emplace_back(2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.0);
  }
  const Topology t = certify_in(Blobs(ring, 1.0, 0.3), cube(4.0));
  EXPECT_TRUE(t.certified);
  EXPECT_EQ(t.components.size(), 1u);
}

TEST(Certified, AgreesWithAFloodFillThatAgreesWithItself) {
  int compared = 0;
  for (int seed = 1; seed <= 10; ++seed) {
    const auto field = geom::testing::field_of(geom::testing::eq13_json(1, seed, 0.7, 1.5));
    const Box box = find_solid(*field, *field->solid_bounds());
    const Topology t = certify_in(*field, box);
    EXPECT_TRUE(t.certified) << seed;
    EXPECT_EQ(t.components_lo, t.components.size());
    EXPECT_EQ(t.components_hi, t.components.size());
    const int coarse = flood_fill(*field, t.box, 96), fine = flood_fill(*field, t.box, 192);
    if (coarse != fine) continue;  // the grid doesn't resolve this field: no witness
    ++compared;
    EXPECT_EQ(t.components.size(), static_cast<std::size_t>(fine)) << seed;
  }
  EXPECT_GE(compared, 5);
}

TEST(Certified, DoesNotDependOnThreadsOrOrigin) {
  const auto field = geom::testing::field_of(geom::testing::eq13_json(1, 3, 0.8, 2.0));
  const Box box = cube(3.5);
  Topology one, two;
  tbb::task_arena(1).execute([&] { one = certify_in(*field, box); });
  tbb::task_arena(2).execute([&] { two = certify_in(*field, box); });
  ASSERT_EQ(one.nodes.size(), two.nodes.size());
  for (std::size_t i = 0; i < one.nodes.size(); ++i) {
    ASSERT_EQ(one.nodes[i].first_child, two.nodes[i].first_child);
    ASSERT_EQ(one.nodes[i].component, two.nodes[i].component);
    ASSERT_EQ(one.nodes[i].faces, two.nodes[i].faces);
  }
  const double shift = 0.1 * std::numbers::sqrt2;
  Box moved = box;
  moved.min -= Imath::V3d(shift, 0.5 * shift, 0.3 * shift);
  const Topology other = certify_in(*field, moved);
  EXPECT_TRUE(one.certified && other.certified);
  EXPECT_EQ(other.components.size(), one.components.size());
  // The same pieces: volumes overlap pairwise, largest first.
  for (std::size_t i = 0; i < std::min<std::size_t>(3, one.components.size()); ++i) {
    EXPECT_LE(one.components[i].volume_lo, other.components[i].volume_hi);
    EXPECT_LE(other.components[i].volume_lo, one.components[i].volume_hi);
  }
}

// The surface touches planes of the octree from one side, in single points.
TEST(Certified, SurfacesTangentToOctreePlanes) {
  // F = 0 at exactly 1/2 from the centre: (1 - 1/4)^3 = 27/64.
  const double level = 27.0 / 64.0;
  const Topology one = certify_in(Blobs({{0, 0, 0}}, 1.0, level), cube(1.0));
  EXPECT_EQ(one.components.size(), 1u);
  EXPECT_LE(one.components_lo, 1u);
  if (one.components_hi) {
    EXPECT_GE(*one.components_hi, 1u);
  }
  // Two that touch one another in the plane between them, where F is 2 27/64 - 27/32 = 0: one
  // component in truth, and two are never certified. A little apart they are two.
  for (const double gap : {0.0, 1e-3}) {
    const Topology two =
        certify_in(Blobs({{-0.5 - gap, 0, 0}, {0.5 + gap, 0, 0}}, 1.0, 2.0 * level), cube(2.0));
    const std::uint64_t truth = gap == 0.0 ? 1 : 2;
    EXPECT_LE(two.components_lo, truth);
    if (two.components_hi) {
      EXPECT_GE(*two.components_hi, truth);
    }
    if (two.certified) {
      EXPECT_EQ(two.components.size(), truth);
    }
  }
}

TEST(Certified, WithoutNoiseAndWithoutSurface) {
  const auto flat = geom::testing::field_of(geom::testing::eq13_json(3, 3, 0.0));
  const Topology ball = certify_in(*flat, cube(1.5));
  EXPECT_TRUE(ball.certified);
  EXPECT_EQ(ball.components.size(), 1u);
  const auto field = geom::testing::field_of(geom::testing::eq13_json(2, 3, 0.1));
  const Topology inside = certify_in(*field, cube(0.2));
  EXPECT_TRUE(inside.certified);
  EXPECT_EQ(inside.components.size(), 1u);
  EXPECT_TRUE(inside.touches_box.has_value());
  const Topology outside = certify_in(*field, cube(1.0, Imath::V3d(5.0, 4.0, 3.0)));
  EXPECT_TRUE(outside.certified);
  EXPECT_EQ(outside.components.size(), 0u);
  EXPECT_EQ(outside.leaves, 1u);
  EXPECT_FALSE(outside.touches_box.has_value());
}

TEST(Certified, ReportsSolidThatTheBoxCuts) {
  const auto field = geom::testing::field_of({{"density", {{"type", "sphere"}, {"radius", 1.0}}}});
  const Topology t = certify_in(*field, Box(Imath::V3d(-2.0), Imath::V3d(2.0, 2.0, 0.5)));
  ASSERT_TRUE(t.touches_box.has_value());
  EXPECT_DOUBLE_EQ(t.touches_box->z, 0.5);
}

// At any moment of the work, while several threads are at it: the exception arrives, and nothing
// else happens. (Loops nested in a cancelled one return as if they had run.)
TEST(Certified, EndsCleanlyInTheMiddleOfTheWork) {
  const std::shared_ptr<const ScalarField> field =
      geom::testing::field_of(geom::testing::eq13_json(1, 3));
  CertifyOptions options;
  options.box = cube(3.0);
  tbb::task_arena arena(4);
  for (const int count : {1, 2, 10, 100, 1000, 5000, 20000, 50000}) {
    std::atomic<bool> cancel{false};
    Execution execution;
    execution.cancel = &cancel;
    Counted::Trigger stop{count, [&] { cancel = true; }};
    arena.execute([&] {
      EXPECT_THROW(certify(Counted(field, stop), options, execution), Cancelled) << count;
    });
    Counted::Trigger fail{count, [] { throw std::bad_alloc(); }};
    arena.execute(
        [&] { EXPECT_THROW(certify(Counted(field, fail), options), std::bad_alloc) << count; });
  }
}

// One tree that would never end, as nothing is ever decided.
TEST(Certified, EndsInTheMiddleOfATree) {
  std::atomic<bool> cancel{false};
  Execution execution;
  execution.cancel = &cancel;
  CertifyOptions options;
  options.box = cube(1.0);
  options.max_depth = kMaxDepth;
  Counted::Trigger stop{100'000, [&] { cancel = true; }};
  EXPECT_THROW(certify(Counted(std::make_shared<Constant>(0.0), stop), options, execution),
               Cancelled);
}

// The memory that is allowed is not left behind by one tree before it is done.
TEST(Certified, AnEndlessTreeEndsAtTheMemoryAllowed) {
  Execution execution;
  execution.max_bytes = std::uint64_t{1} << 20;
  CertifyOptions options;
  options.box = cube(1.0);
  options.max_depth = kMaxDepth;
  int models = 1'000'000;
  Counted::Trigger stop{models, [] { FAIL() << "so many models make more than 1 MiB"; }};
  EXPECT_THROW(certify(Counted(std::make_shared<Constant>(0.0), stop), options, execution),
               MemoryLimit);
}

// Flat faces in planes of the octree, and planes that cross two of them in one line: reported as
// undecided, at once and not after 2^20 cells along each edge.
TEST(Certified, SurfacesInPlanesOfTheOctreeEndSoon) {
  for (const Imath::V3d& slope :
       {Imath::V3d(0, 0, -1), Imath::V3d(1, 0, 1), Imath::V3d(-1, 2, 0)}) {
    const Linear field(slope, 0.0);
    Counted::Trigger many{100'000, [] { FAIL() << "no end"; }};
    CertifyOptions options;
    options.box = cube(1.0);
    options.max_depth = kMaxDepth;
    const Topology t = certify(Counted(std::make_shared<Linear>(field), many), options);
    EXPECT_EQ(t.components.size(), 1u);
    EXPECT_EQ(t.components_lo, 1u);
    EXPECT_FALSE(t.certified);
    for (const OctreeNode& node : t.nodes) ASSERT_EQ(node.reserved, 0);
    VerifyOptions full;
    full.full = true;
    EXPECT_TRUE(verify(field, t, full).passed());
    // Next to it there is nothing of the kind.
    options.box = cube(1.0, Imath::V3d(1e-9, 3e-9, -2e-9));
    const Linear beside(slope, 1e-9);
    EXPECT_TRUE(certify(beside, options).certified);
  }
}

// Whatever the depth limit: where nothing is decided, little is known.
TEST(Certified, VolumesAndBoxesHoldWhereCellsAreUndecided) {
  const double radius = std::sqrt(1.0 - std::cbrt(0.3));
  const double volume = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  const Imath::V3d centre(0.1, -0.2, 0.3);
  const Blobs ball({centre}, 1.0, 0.3);
  bool undecided = false;
  for (int depth = 2; depth < 9; ++depth) {
    CertifyOptions options;
    options.box = cube(2.0);
    options.min_depth = 1;
    options.max_depth = depth;
    const Topology t = certify(ball, options);
    undecided = undecided || t.unresolved_cells > 0;
    for (const Component& c : t.components) {
      EXPECT_LE(c.volume_lo, volume) << depth;
      EXPECT_GE(c.volume_hi, volume) << depth;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(c.bounds.min[axis], centre[axis] - radius) << depth;
        EXPECT_GE(c.bounds.max[axis], centre[axis] + radius) << depth;
      }
    }
  }
  EXPECT_TRUE(undecided);
}

// x - 0.3, except that nothing is known of it, or that it is not finite, beyond x = 1/2.
class Unbounded final : public ScalarField {
 public:
  explicit Unbounded(double beyond) : beyond_(beyond) {}
  double value(const Imath::V3d& x) const override {
    return x.x > 0.5 && !std::isfinite(beyond_) ? beyond_ : x.x - 0.3;
  }
  Jet jet(const Imath::V3d& x) const override {
    return {.value = value(x), .gradient = Imath::V3d(1.0, 0.0, 0.0), .hessian = {}};
  }
  LocalModel model(const Box& box) const override {
    LocalModel m;
    m.centre = centre(box);
    m.half = half_size(box);
    m.c[monomial::k1] = m.centre.x - 0.3;
    m.c[monomial::kX] = 1.0;
    if (box.max.x > 0.5 && box.max.x - box.min.x > known_up_to_) {
      constexpr double kInfinity = std::numeric_limits<double>::infinity();
      m.value_error = m.hessian_error = kInfinity;
      m.gradient_error = Imath::V3d(kInfinity);
    }
    m.add_rounding();
    return m;
  }
  std::unique_ptr<ScalarField> restricted_to(const Box&) const override {
    return std::make_unique<Unbounded>(*this);
  }
  double known_up_to_ = 0.0;

 private:
  double beyond_;
};

TEST(Certified, WhatIsNotFiniteIsAnErrorWithItsPlace) {
  const auto error_of = [](const Unbounded& field, const Box& box) -> std::string {
    try {
      certify_in(field, box);
    } catch (const NotFinite& e) {
      return e.what();
    }
    return "";
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double value : {-kInfinity, kInfinity, std::nan("")}) {
    const std::string error = error_of(Unbounded(value), Box(Imath::V3d(0.55), Imath::V3d(1.0)));
    EXPECT_NE(error.find("not finite at (0."), std::string::npos) << error;
    EXPECT_NE(error.find(std::isnan(value) ? "nan" : "inf"), std::string::npos) << error;
    EXPECT_NE(error_of(Unbounded(value), cube(1.0)), "");
  }
  // F is finite, but its bounds are not.
  const std::string error = error_of(Unbounded(1.0), cube(1.0));
  EXPECT_NE(error.find("no bounds of it are known"), std::string::npos) << error;
  EXPECT_NE(error.find("near (0."), std::string::npos) << error;
  // Those of wide boxes may be missing.
  Unbounded field(1.0);
  field.known_up_to_ = 0.03;
  const Topology t = certify_in(field, cube(1.0));
  EXPECT_TRUE(t.certified);
  EXPECT_EQ(t.components.size(), 1u);
}

TEST(Certified, CancelsAndRefusesBadOptions) {
  const auto field = geom::testing::field_of(geom::testing::eq13_json(1, 3));
  std::atomic<bool> cancel{true};
  Execution execution;
  execution.cancel = &cancel;
  CertifyOptions options;
  options.box = cube(3.0);
  EXPECT_THROW(certify(*field, options, execution), Cancelled);
  options.box.max.x = std::nan("");
  EXPECT_THROW(certify(*field, options), std::invalid_argument);
  options.box = cube(3.0);
  options.max_depth = 99;
  EXPECT_THROW(certify(*field, options), std::invalid_argument);
}

TEST(DyadicBox, PlanesAreExactAndNearOnesAreKept) {
  for (const double offset : {0.0, 1.0, 1000.0, 1e5}) {
    const Box box(Imath::V3d(offset - 2.9, -2.9, 0.1), Imath::V3d(offset + 2.9, 3.3, 0.2));
    const Box d = dyadic_box(box);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(d.min[axis], box.min[axis]);
      EXPECT_GE(d.max[axis], box.max[axis]);
      EXPECT_LE(d.max[axis] - d.min[axis], 1.05 * (box.max[axis] - box.min[axis]) + 1e-2);
    }
    Box cell = d;
    for (int depth = 0; depth < kMaxDepth; ++depth) {
      const Box child = child_box(cell, depth % 8);
      for (int axis = 0; axis < 3; ++axis) {
        // The middle is exact: it is as far from either end.
        const double middle = centre(cell)[axis];
        EXPECT_EQ(middle - cell.min[axis], cell.max[axis] - middle);
      }
      cell = child;
    }
  }
}

}  // namespace
}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
// The three solvers and the membership filters give the same surface.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "hypertexture_geom/embree/lipschitz.h"
#include "tests/hypertexture_geom/ball_geometry.h"
#include "tests/hypertexture_geom/eq13.h"

namespace morsel::geom {
namespace {

using test::random_direction;
using test::random_point;
using test::ray_of;

struct Traced {
  Traced(const std::shared_ptr<const Field>& field,
         const std::shared_ptr<const topology::TopologyCache>& cache, GeometryOptions options)
      : geometry(field, cache, options) {
    scene.attach(geometry.create(scene.device()));
    scene.commit();
  }
  HypertextureGeometry geometry;
  test::EmbreeScene scene;
};

GeometryOptions with(Solver solver, Membership membership = Membership::kLabels) {
  GeometryOptions options;
  options.solver = solver;
  options.membership = membership;
  options.check_bounds = true;
  return options;
}

// Rays at both: counts those that disagree by more than `tolerance` along the ray.
int differences(const Traced& a, const Traced& b, int rays, float half, double tolerance,
                int* hits = nullptr) {
  std::mt19937 random(7);
  int different = 0;
  for (int i = 0; i < rays; ++i) {
    const Imath::V3f o = random_point(random, i % 2 ? half : 3.0f * half);
    const Imath::V3f d = i % 2 ? random_direction(random) : random_point(random, half) - o;
    const RTCRayHit p = a.scene.intersect(ray_of(o, d)), q = b.scene.intersect(ray_of(o, d));
    EXPECT_EQ(a.scene.occluded(ray_of(o, d)), test::is_hit(p)) << i;
    EXPECT_EQ(b.scene.occluded(ray_of(o, d)), test::is_hit(q)) << i;
    const bool same =
        test::is_hit(p) == test::is_hit(q) &&
        (!test::is_hit(p) || static_cast<double>(std::abs(p.ray.tfar - q.ray.tfar) * d.length()) <=
                                 tolerance * (1.0 + static_cast<double>(p.ray.tfar * d.length())));
    different += same ? 0 : 1;
    if (hits) *hits += test::is_hit(p);
  }
  return different;
}

class SolversTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    rock_ = std::make_unique<Hypertexture>(test::eq13(1));
    cache_ = std::make_shared<topology::TopologyCache>(build_cache(*rock_));
    model_ = std::make_unique<Traced>(rock_->field, cache_, with(Solver::kModel));
  }
  static void TearDownTestSuite() {
    model_.reset();
    cache_.reset();
    rock_.reset();
  }
  static void expect_same(const Traced& other, int rays) {
    int hits = 0;
    EXPECT_EQ(differences(*model_, other, rays, 1.8f, 1e-6, &hits), 0);
    EXPECT_GT(hits, rays / 5);
    for (const Traced* t : {static_cast<const Traced*>(model_.get()), &other}) {
      EXPECT_EQ(t->geometry.statistics().violations, 0u);
      EXPECT_EQ(t->geometry.statistics().limits, 0u);
    }
  }
  static inline std::unique_ptr<Hypertexture> rock_;
  static inline std::shared_ptr<const topology::TopologyCache> cache_;
  static inline std::unique_ptr<Traced> model_;
};

TEST_F(SolversTest, SegmentAgreesWithModel) {
  expect_same(Traced(rock_->field, cache_, with(Solver::kSegment)), 20000);
}

TEST_F(SolversTest, SphereAgreesWithModel) {
  const Traced sphere(rock_->field, cache_, with(Solver::kSphere));
  EXPECT_EQ(sphere.geometry.statistics().bricks, 1u);
  expect_same(sphere, 1000);
  // Its one primitive has no component, a place on it has.
  const RTCRayHit h = sphere.scene.intersect(ray_of({0, 0, 9}, {0, 0, -1}));
  ASSERT_TRUE(test::is_hit(h));
  const Imath::V3d p(0, 0, 9.0 - static_cast<double>(h.ray.tfar));
  EXPECT_EQ(sphere.geometry.component(0), topology::kNoComponent);
  EXPECT_EQ(sphere.geometry.component_at(0, p), sphere.geometry.main_component());
  EXPECT_EQ(sphere.geometry.shade(0, Imath::V3f(p)).component, sphere.geometry.main_component());
}

TEST_F(SolversTest, TheDebrisAlone) {
  GeometryOptions options = with(Solver::kModel);
  options.keep = topology::KeepRule::parse("detached");
  const Traced model(rock_->field, cache_, options);
  options.solver = Solver::kSphere;
  const Traced sphere(rock_->field, cache_, options);
  EXPECT_EQ(differences(model, sphere, 300, 2.5f, 1e-6), 0);
}

TEST_F(SolversTest, StreamlinesAgreeWithLabels) {
  const Traced streamline(rock_->field, cache_, with(Solver::kModel, Membership::kStreamline));
  EXPECT_GT(streamline.geometry.statistics().bricks, model_->geometry.statistics().bricks);
  EXPECT_EQ(differences(*model_, streamline, 200, 1.8f, 1e-6), 0);
}

TEST_F(SolversTest, MembershipOffKeepsAll) {
  GeometryOptions options = with(Solver::kModel);
  options.keep = topology::KeepRule::parse("all");
  const Traced all(rock_->field, cache_, options);
  const Traced off(rock_->field, cache_, with(Solver::kModel, Membership::kOff));
  EXPECT_EQ(differences(all, off, 4000, 2.5f, 0.0), 0);
  EXPECT_GT(differences(*model_, off, 4000, 2.5f, 1e-6), 0);
}

TEST_F(SolversTest, LipschitzBoundHoldsAndIsTight) {
  const topology::Box box = model_->geometry.bounds();
  const double bound = lipschitz_bound(*rock_->field, box);
  std::mt19937 random(4);
  double greatest = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const Imath::V3d x =
        topology::centre(box) + Imath::V3d(random_point(random, 1.0f)) * topology::half_size(box);
    greatest = std::max(greatest, rock_->field->jet(x).gradient.length());
  }
  EXPECT_LE(greatest, bound);
  EXPECT_LE(bound, 1.25 * greatest);
}

// A wrong bound must be noticed: a field whose gradient, and with it its models, errs.
class LyingField final : public test::BallField {
 public:
  using BallField::BallField;
  double value(const Imath::V3d& x) const override { return BallField::value(x) + 0.3 * x.x; }
  std::unique_ptr<topology::ScalarField> restricted_to(const topology::Box&) const override {
    return std::make_unique<LyingField>(*this);
  }
};

TEST(CheckBounds, NoticesModelsThatErr) {
  topology::CertifyOptions certify;
  certify.box = topology::dyadic_box({Imath::V3d(-1.0), Imath::V3d(1.0)});
  certify.min_depth = 4;
  const auto honest = std::make_shared<test::BallField>(Imath::V3d(0.1, 0.0, 0.0), 0.7);
  const auto lying = std::make_shared<LyingField>(Imath::V3d(0.1, 0.0, 0.0), 0.7);
  const auto cache = test::certified_cache(*honest, certify);
  for (const Solver solver : {Solver::kModel, Solver::kSegment}) {
    const Traced good(honest, cache, with(solver)), bad(lying, cache, with(solver));
    std::mt19937 random(3);
    for (int i = 0; i < 2000; ++i) {
      const RTCRay ray = ray_of(random_point(random, 1.0f), random_direction(random));
      good.scene.intersect(ray);
      bad.scene.intersect(ray);
    }
    EXPECT_EQ(good.geometry.statistics().violations, 0u);
    EXPECT_GT(bad.geometry.statistics().violations, 0u);
  }
}

// Two balls that almost touch, F = max of both, in an octree too shallow to tell them apart: the
// leaves between are undecided, and hits there are put to the filter.
class TwoBalls final : public Field {
 public:
  explicit TwoBalls(double gap) : a_({-0.5 - gap, 0.01, 0.02}, 0.5), b_({0.4, 0.01, 0.02}, 0.4) {}
  double value(const Imath::V3d& x) const override { return side(x).value(x); }
  topology::Jet jet(const Imath::V3d& x) const override { return side(x).jet(x); }
  topology::LocalModel model(const topology::Box& box) const override {
    if (box.max.x < middle()) return a_.model(box);
    if (box.min.x > middle()) return b_.model(box);
    // Nothing of the derivatives; F's range by the larger of the two.
    topology::LocalModel m = a_.model(box);
    const topology::Interval p = m.range(), q = b_.model(box).range();
    m.c.fill(0.0);
    const topology::Interval r{std::max(p.lo, q.lo), std::max(p.hi, q.hi)};
    m.c[0] = r.middle();
    m.value_error = 0.5 * r.width() * (1.0 + 1e-12);
    m.gradient_error = Imath::V3d(10.0);
    m.hessian_error = std::numeric_limits<double>::infinity();
    m.add_rounding();
    return m;
  }
  std::unique_ptr<topology::ScalarField> restricted_to(const topology::Box&) const override {
    return std::make_unique<TwoBalls>(*this);
  }
  nlohmann::json canonical_json() const override { return {{"type", "two balls"}}; }
  std::optional<topology::Box> solid_bounds() const override {
    return topology::Box(Imath::V3d(-2.0), Imath::V3d(2.0));
  }
  double middle() const { return 0.5 * (a_.centre().x + a_.radius()); }

 private:
  const test::BallField& side(const Imath::V3d& x) const {
    return a_.value(x) > b_.value(x) ? a_ : b_;
  }
  test::BallField a_, b_;
};

TEST(MixedCells, HitsInUndecidedLeavesGoThroughTheFilter) {
  const auto field = std::make_shared<TwoBalls>(1e-3);
  topology::CertifyOptions certify;
  certify.box = topology::dyadic_box({Imath::V3d(-1.3), Imath::V3d(1.3)});
  certify.min_depth = certify.max_depth = 5;
  const auto cache = test::certified_cache(*field, certify);
  ASSERT_FALSE(cache->topology.certified);
  ASSERT_GT(cache->topology.unresolved_cells, 0u);
  const topology::OctreeView octree = cache->topology.octree();
  const std::uint32_t large = octree.nodes[octree.locate({-0.6, 0.0, 0.0}).node].component;
  const std::uint32_t small = octree.nodes[octree.locate({0.4, 0.0, 0.0}).node].component;
  ASSERT_NE(large, small);

  for (const Solver solver : {Solver::kModel, Solver::kSegment, Solver::kSphere}) {
    GeometryOptions options = with(solver);
    options.check_bounds = false;
    options.keep = topology::KeepRule::parse("ids:" + std::to_string(large));
    const Traced one(field, cache, options);
    options.membership = Membership::kOff;
    const Traced both(field, cache, options);
    std::mt19937 random(9);
    int of_small = 0;
    for (int i = 0; i < 3000; ++i) {
      // At the place where the balls almost touch.
      const Imath::V3f target = random_point(random, 0.08f), d = random_direction(random);
      const Imath::V3f o = target - d * 3.0f;
      const RTCRayHit p = one.scene.intersect(ray_of(o, d)), q = both.scene.intersect(ray_of(o, d));
      if (test::is_hit(p)) {
        EXPECT_LT(o.x + d.x * p.ray.tfar, -5e-4f) << i;
      }
      EXPECT_EQ(one.scene.occluded(ray_of(o, d)), test::is_hit(p)) << i;
      if (!test::is_hit(q)) {
        EXPECT_FALSE(test::is_hit(p)) << i;
        continue;
      }
      const float x = o.x + d.x * q.ray.tfar;
      if (x > -5e-4f)
        ++of_small;
      else
        // F has a kink between the balls, where no bound on its curvature holds: a chord shorter
        // than this may be seen by one solver only.
        EXPECT_NEAR(p.ray.tfar, q.ray.tfar, 1e-4f) << i << " " << static_cast<int>(solver);
    }
    EXPECT_GT(of_small, 300);
  }
}

}  // namespace
}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
// Ray tests that end at the evaluation limit are counted, by the geometry and by the thread.
#include <gtest/gtest.h>

#include "hypertexture_geom/embree/ray_surface.h"
#include "tests/hypertexture_geom/ball_field.h"
#include "tests/hypertexture_geom/embree_scene.h"

namespace morsel::geom {
namespace {

// F = 0.1 - z. Its models are true; wide ones say so little that a ray along the plane, just above
// it, is excluded by tiny steps only.
class Plane final : public Field {
 public:
  explicit Plane(bool wide) : wide_(wide) {}
  double value(const Imath::V3d& x) const override { return 0.1 - x.z; }
  topology::Jet jet(const Imath::V3d& x) const override {
    topology::Jet j;
    j.value = value(x);
    j.gradient = {0.0, 0.0, -1.0};
    return j;
  }
  topology::LocalModel model(const topology::Box& box) const override {
    topology::LocalModel m;
    m.centre = topology::centre(box);
    m.half = topology::half_size(box);
    m.c[topology::monomial::k1] = value(m.centre);
    m.c[topology::monomial::kZ] = -1.0;
    m.value_error = wide_ ? 1.0 : 1e-14;
    m.gradient_error = Imath::V3d(wide_ ? 10.0 : 1e-14);
    m.hessian_error = wide_ ? 1e6 : 1e-14;
    m.add_rounding();
    return m;
  }
  std::unique_ptr<topology::ScalarField> restricted_to(const topology::Box&) const override {
    return std::make_unique<Plane>(*this);
  }
  nlohmann::json canonical_json() const override { return {{"type", "plane"}}; }
  std::optional<topology::Box> solid_bounds() const override {
    return topology::Box(Imath::V3d(-1.0), Imath::V3d(1.0));
  }

 private:
  bool wide_;
};

class StepLimit : public ::testing::TestWithParam<Solver> {};

TEST_P(StepLimit, IsCounted) {
  // Sphere tracing knows no more than the models say, too: its bound must not be sought for ever.
  const auto field = std::make_shared<Plane>(true);
  topology::CertifyOptions certify;
  certify.box = topology::dyadic_box({Imath::V3d(-1.0), Imath::V3d(1.0)});
  certify.min_depth = certify.max_depth = 3;
  GeometryOptions options;
  options.solver = GetParam();
  options.membership = Membership::kOff;
  const HypertextureGeometry geometry(field, test::certified_cache(Plane(false), certify), options);
  test::EmbreeScene scene;
  scene.attach(geometry.create(scene.device()));
  scene.commit();

  // Across the plane: no limit, and a hit.
  RayStatistics before = ray_statistics();
  EXPECT_NEAR(scene.intersect(test::ray_of({0.1f, 0.2f, 0.9f}, {0, 0, -1})).ray.tfar, 0.8f, 1e-5f);
  EXPECT_EQ(geometry.statistics().limits, 0u);
  EXPECT_EQ(ray_statistics().limits, before.limits);

  // Along it.
  before = ray_statistics();
  EXPECT_FALSE(test::is_hit(scene.intersect(test::ray_of({-3.0f, 0.2f, 0.1000005f}, {1, 0, 0}))));
  const std::uint64_t once = geometry.statistics().limits;
  EXPECT_GT(once, 0u);
  EXPECT_EQ(ray_statistics().limits - before.limits, once);
  EXPECT_FALSE(scene.occluded(test::ray_of({-3.0f, 0.2f, 0.1000005f}, {1, 0, 0})));
  EXPECT_EQ(geometry.statistics().limits, 2 * once);
}

INSTANTIATE_TEST_SUITE_P(Solvers, StepLimit,
                         ::testing::Values(Solver::kModel, Solver::kSegment, Solver::kSphere));

}  // namespace
}  // namespace morsel::geom

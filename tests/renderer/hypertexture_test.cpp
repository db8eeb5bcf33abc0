// SPDX-License-Identifier: Apache-2.0
// Hypertexture in the renderer: hits, spawn points, materials by component, whole renders.
#include "hypertexture_geom/embree/geometry.h"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "renderer/accel/scene_accel.h"
#include "renderer/integrator/render.h"
#include "tests/hypertexture_geom/ball_field.h"
#include "tests/hypertexture_geom/eq13.h"
#include "tests/renderer/statistics.h"
#include "tests/renderer/test_scenes.h"

namespace morsel::render {
namespace {

using namespace testing;
using Shape = std::shared_ptr<const geom::HypertextureGeometry>;

Shape ball() {
  static const Shape shape = [] {
    const auto field = std::make_shared<geom::test::BallField>(V3d(0.0), 1.0);
    topology::CertifyOptions options;
    options.box = topology::Box(V3d(-1.25), V3d(1.25));
    options.min_depth = 4;
    return std::make_shared<const geom::HypertextureGeometry>(
        field, geom::test::certified_cache(*field, options), geom::GeometryOptions{});
  }();
  return shape;
}

// The paper's field with one layer, all pieces kept.
Shape rock() {
  static const Shape shape = [] {
    const geom::Hypertexture h = geom::test::eq13(1);
    geom::GeometryOptions options;
    options.keep.kind = topology::KeepRule::Kind::kAll;
    return std::make_shared<const geom::HypertextureGeometry>(
        h.field, std::make_shared<const topology::TopologyCache>(geom::build_cache(h)), options);
  }();
  return shape;
}

void add_hypertexture(Scene& scene, const Shape& shape, std::uint32_t material,
                      const Imath::M44d& object_to_world = Imath::M44d()) {
  scene.geometries.push_back({"hypertexture", shape});
  Instance instance;
  instance.name = "hypertexture";
  instance.geometry = static_cast<std::uint32_t>(scene.geometries.size() - 1);
  instance.material = material;
  instance.object_to_world = object_to_world;
  scene.instances.push_back(instance);
}

struct Placement {
  const char* name;
  Imath::M44d transform;
};
void PrintTo(const Placement& p, std::ostream* out) { *out << p.name; }

class PlacedBall : public ::testing::TestWithParam<Placement> {
 protected:
  PlacedBall() {
    add_material(scene_, MaterialType::kDiffuse, V3f(0.5f));
    add_hypertexture(scene_, ball(), 0, GetParam().transform);
  }
  V3f to_world(const V3f& p) const { return V3f(V3d(p) * GetParam().transform); }
  Scene scene_;
};

TEST_P(PlacedBall, SpawnedRaysAreOnTheSideTheyShouldBe) {
  const SceneAccel accel(scene_);
  const FlushDenormals flush;
  Random random;
  const V3f centre = to_world(V3f(0.0f));
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    Ray ray;
    ray.origin = centre + (to_world(random.direction()) - centre) * 3.0f;
    ray.direction = to_world(random.direction() * 0.7f) - ray.origin;
    SurfaceInteraction s;
    ASSERT_TRUE(accel.intersect(ray, RayKind::kBounce, s));
    ++hits;
    ASSERT_LT(dot(ray.direction, s.geometric_normal), 0.0f) << "normals point out";
    ASSERT_NEAR(dot(s.geometric_normal, s.geometric_normal), 1.0f, 1e-5f);
    ASSERT_EQ(s.component, 0u);
    for (int k = 0; k < 4; ++k) {
      V3f d = random.direction();
      if (k == 0) d = normalize(d - s.geometric_normal * (0.99f * dot(d, s.geometric_normal)));
      const float cosine = dot(d, s.geometric_normal);
      Ray spawned;
      spawned.origin = s.spawn(d);
      spawned.direction = d;
      SurfaceInteraction next;
      const bool hit = accel.intersect(spawned, RayKind::kBounce, next);
      if (cosine > 0.0f) {
        ASSERT_FALSE(hit) << i << ", t " << next.t << ", cosine " << cosine;
      } else if (cosine < -0.05f) {
        ASSERT_TRUE(hit) << i << ", cosine " << cosine;
        // From the inside the next hit is the far side, where the ray leaves.
        ASSERT_GT(dot(d, next.geometric_normal), 0.0f);
      }
    }
  }
  EXPECT_EQ(hits, 5000);
}

INSTANTIATE_TEST_SUITE_P(
    Everywhere, PlacedBall,
    ::testing::Values(Placement{"origin", Imath::M44d()},
                      Placement{"away", translated(30, -20, 10)},
                      Placement{"small", scaled(1e-2, 1e-2, 1e-2)},
                      Placement{"mirrored", scaled(-1, 1, 1) * translated(3, 0, 0)},
                      Placement{"stretched",
                                scaled(2, 0.5, 1) * rotated_y(30) * translated(20, 0, 7)}),
    [](const auto& p) { return std::string(p.param.name); });

TEST(HypertextureFurnace, DiffuseBallReflectsItsAlbedo) {
  for (const float albedo : {1.0f, 0.5f}) {
    Scene scene;
    add_material(scene, MaterialType::kDiffuse, V3f(albedo));
    add_hypertexture(scene, ball(), 0);
    add_constant_environment(scene, 1.0f);
    scene.camera.position = V3f(0, 0, 4);
    scene.camera.vertical_fov = 20.0f;
    set_image(scene, 16, 16, 16);
    const RenderResult result = render(scene);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) {
        const Pixel& p = result.film.at(x, y);
        EXPECT_NEAR(p.color.x, albedo, 6.0f * std::sqrt(p.variance.x) + 1e-3f);
        EXPECT_EQ(p.component, 1.0f);
      }
    EXPECT_EQ(result.statistics.non_finite_samples, 0u);
  }
}

// The rock alone under a white sky.
Scene rock_scene(MaterialType type, float color) {
  Scene scene;
  add_material(scene, type, V3f(color));
  add_hypertexture(scene, rock(), 0);
  add_constant_environment(scene, 1.0f);
  scene.camera.position = V3f(0, 0, 6);
  return scene;
}

TEST(HypertextureFurnace, ClearGlassVanishes) {
  Scene scene = rock_scene(MaterialType::kDielectric, 1.0f);
  set_image(scene, 32, 32, 8, 200);
  const RenderResult result = render(scene);
  double sum = 0.0;
  int off = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const float value = result.film.at(x, y).color.x;
      sum += value / (32.0 * 32.0);
      off += std::abs(value - 1.0f) > 0.02f;
    }
  // Long total reflections are cut by the depth limit and by Russian roulette.
  EXPECT_NEAR(sum, 1.0, 0.01);
  EXPECT_LT(off, 20);
}

TEST(HypertextureDeterminism, ThreadsAndCropChangeNoPixel) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.6f));
  add_material(scene, MaterialType::kConductor, V3f(0.9f), 0.3f);
  add_hypertexture(scene, rock(), 0, rotated_y(20));
  add_mesh(scene, plane_mesh(8.0f, -1.5f), 1);
  add_constant_environment(scene, 0.5f);
  add_rectangle(scene, V3f(-1, 4, -1), V3f(2, 0, 0), V3f(0, 0, 2), 8.0f);
  scene.camera.position = V3f(1, 2, 6);
  set_image(scene, 72, 48, 4, 4);
  RenderOptions one, two;
  one.threads = 1;
  two.threads = 2;
  const RenderResult a = render(scene, one);
  const RenderResult b = render(scene, two);
  scene.settings.crop = Crop{11, 5, 60, 41};
  const RenderResult c = render(scene, two);
  const auto all = [](const Pixel& p) {
    return std::tuple(p.color, p.alpha, p.albedo, p.normal, p.variance, p.depth, p.component,
                      p.samples, p.steps);
  };
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 72; ++x) {
      ASSERT_EQ(all(a.film.at(x, y)), all(b.film.at(x, y))) << x << ", " << y;
      if (x >= 11 && x < 60 && y >= 5 && y < 41) {
        ASSERT_EQ(all(a.film.at(x, y)), all(c.film.at(x, y))) << x << ", " << y;
      }
    }
}

// The layer "steps" counts the camera's rays alone, those that miss included.
TEST(HypertextureSteps, AreThoseOfTheCamerasRays) {
  Scene scene = rock_scene(MaterialType::kDiffuse, 0.6f);
  set_image(scene, 48, 48, 2, 4);
  const RenderResult result = render(scene);
  double sum = 0.0;
  int hits = 0, corner = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 48; ++x) {
      const Pixel& p = result.film.at(x, y);
      sum += static_cast<double>(p.steps) * p.samples;
      if (p.component != 0.0f) {
        EXPECT_GT(p.steps, 0.0f) << x << ", " << y;
        ++hits;
      }
      corner += x < 2 && y < 2 && p.steps == 0.0f;
    }
  EXPECT_GT(hits, 200);
  EXPECT_EQ(corner, 4);
  const RayCost& cost = result.statistics.rays.costs[static_cast<std::size_t>(RayUse::kCamera)];
  // Means are stored as float.
  EXPECT_NEAR(sum, static_cast<double>(cost.evaluations), 1e-6 * sum);
}

TEST(HypertextureComponents, DetachedPiecesHaveTheirOwnMaterialAndNumber) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.5f));
  add_material(scene, MaterialType::kDiffuse, V3f(0.9f, 0.0f, 0.0f));
  add_hypertexture(scene, rock(), 0);
  scene.instances[0].detached_material = 1;
  add_constant_environment(scene, 1.0f);
  scene.camera.position = V3f(0, 0, 6);
  scene.camera.vertical_fov = 50.0f;
  set_image(scene, 96, 96, 1, 0);
  const RenderResult result = render(scene);
  const float main = 1.0f + static_cast<float>(rock()->main_component());
  std::set<float> components;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      const Pixel& p = result.film.at(x, y);
      components.insert(p.component);
      if (p.component == 0.0f)
        EXPECT_EQ(p.depth, kFarDepth);
      else
        EXPECT_EQ(p.albedo, p.component == main ? V3f(0.5f) : V3f(0.9f, 0.0f, 0.0f));
    }
  EXPECT_TRUE(components.contains(0.0f));
  EXPECT_TRUE(components.contains(main));
  EXPECT_GT(components.size(), 5u);
}

}  // namespace
}  // namespace morsel::render

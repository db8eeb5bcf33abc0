// SPDX-License-Identifier: Apache-2.0
// Colours by numbers of the hit: against closed forms, differences and pictures.
#include "renderer/texture/ramp.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hypertexture_geom/embree/geometry.h"
#include "renderer/accel/scene_accel.h"
#include "renderer/integrator/render.h"
#include "tests/hypertexture_geom/eq13.h"
#include "tests/renderer/test_scenes.h"

namespace morsel::render {
namespace {

using namespace testing;

TEST(Ramp, InterpolatesItsStops) {
  RampTexture ramp;
  ramp.low = 2.0f;
  ramp.high = 4.0f;
  ramp.stops = {{0.0f, V3f(0.0f)}, {0.5f, V3f(1.0f, 0.0f, 0.0f)}, {1.0f, V3f(0.0f, 1.0f, 0.0f)}};
  EXPECT_EQ(ramp_color(ramp, 0.0f), V3f(0.0f));
  EXPECT_EQ(ramp_color(ramp, 2.5f), V3f(0.5f, 0.0f, 0.0f));
  EXPECT_EQ(ramp_color(ramp, 3.5f), V3f(0.5f, 0.5f, 0.0f));
  EXPECT_EQ(ramp_color(ramp, 9.0f), V3f(0.0f, 1.0f, 0.0f));
}

// The paper's field with one layer, all pieces kept, as an instance that is turned, scaled and
// moved, seen from the front.
Scene rock_scene() {
  static const auto shape = [] {
    const geom::Hypertexture h = geom::test::eq13(1);
    geom::GeometryOptions options;
    options.keep.kind = topology::KeepRule::Kind::kAll;
    return std::make_shared<const geom::HypertextureGeometry>(
        h.field, std::make_shared<const topology::TopologyCache>(geom::build_cache(h)), options);
  }();
  Scene scene;
  add_material(scene, MaterialType::kPrincipled, V3f(1.0f));
  scene.materials[0].specular = 0.0f;
  scene.geometries.push_back({"rock", shape});
  Instance instance;
  instance.name = "rock";
  instance.object_to_world = rotated_y(70.0) * scaled(2, 2, 2) * translated(1, -2, 0.5);
  scene.instances.push_back(instance);
  add_constant_environment(scene, 1.0f);
  scene.camera.position = V3f(1, -2, 12);
  scene.camera.look_at = V3f(1, -2, 0.5f);
  return scene;
}

TEST(Ramp, NumbersOfARealHypertexture) {
  const Scene scene = rock_scene();
  const SceneAccel accel(scene);
  const auto& rock =
      *std::get<std::shared_ptr<const geom::HypertextureGeometry>>(scene.geometries[0].shape);
  const Imath::M44d to_object = scene.instances[0].object_to_world.inverse();
  int hits = 0, detached = 0;
  double flattest = 1e9, sharpest = -1e9;
  for (int i = 0; i < 4096; ++i) {
    Ray ray;
    ray.origin = scene.camera.position;
    ray.direction = normalize(V3f(static_cast<float>(i % 64) / 63.0f - 0.5f,
                                  static_cast<float>(i / 64) / 63.0f - 0.5f, -1.9f));
    SurfaceInteraction hit;
    if (!accel.intersect(ray, RayKind::kCamera, hit)) continue;
    ++hits;
    V3d p;
    to_object.multVecMatrix(V3d(hit.p), p);
    const auto value = [&](RampInput input) { return double{*ramp_input(scene, input, hit)}; };
    // D is the sphere's; on the surface the noise is what is missing to 0.
    EXPECT_NEAR(value(RampInput::kDensity), 1.0 - p.length(), 2e-3);
    EXPECT_NEAR(value(RampInput::kNoise), p.length() - 1.0, 2e-3);
    EXPECT_NEAR(value(RampInput::kHeight), p.y, 1e-5);
    // Half the divergence of the outward normal, by differences of gradients.
    const auto normal = [&](const V3d& x) { return -rock.field().jet(x).gradient.normalized(); };
    double divergence = 0.0;
    constexpr double kStep = 1e-5;
    for (int k = 0; k < 3; ++k) {
      V3d step(0.0);
      step[k] = kStep;
      divergence += (normal(p + step)[k] - normal(p - step)[k]) / (2.0 * kStep);
    }
    EXPECT_NEAR(value(RampInput::kCurvature), 0.5 * divergence,
                1e-3 * (1.0 + std::abs(divergence)));
    flattest = std::min(flattest, value(RampInput::kCurvature));
    sharpest = std::max(sharpest, value(RampInput::kCurvature));
    const auto count = static_cast<double>(rock.components().size());
    EXPECT_NEAR(value(RampInput::kComponent), rock.component_at(hit.primitive, p) / count, 1e-6);
    detached += value(RampInput::kComponent) != rock.main_component() / count;
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(detached, 10);
  EXPECT_LT(flattest, -1.0) << "a cavity";
  EXPECT_GT(sharpest, 1.0) << "an edge";
}

TEST(Ramp, MeshesHaveTheirHeightOnly) {
  Scene scene;
  add_material(scene, MaterialType::kPrincipled, V3f(1.0f));
  add_mesh(scene, sphere_mesh(2), 0);
  SurfaceInteraction hit;
  hit.geometry = 0;
  hit.object_p = V3f(0.1f, 0.7f, 0.2f);
  EXPECT_EQ(ramp_input(scene, RampInput::kHeight, hit), 0.7f);
  for (const RampInput input :
       {RampInput::kDensity, RampInput::kNoise, RampInput::kCurvature, RampInput::kComponent})
    EXPECT_FALSE(ramp_input(scene, input, hit).has_value());
}

// From the number to the colour in the picture.
TEST(Ramp, ColoursARenderedHypertexture) {
  Scene scene = rock_scene();
  RampTexture ramp;
  ramp.input = RampInput::kDensity;
  ramp.low = -0.6f;
  ramp.high = 0.6f;
  ramp.stops = {{0.0f, V3f(1.0f, 0.0f, 0.2f)}, {1.0f, V3f(0.0f, 0.5f, 0.2f)}};
  scene.textures.push_back({"ramp", ramp, TextureChannel::kLuminance});
  scene.materials[0].texture(MaterialInput::kColor) = 0;
  set_image(scene, 48, 48, 1, 0);
  const Film film = render(scene).film;
  const Imath::M44d to_object = scene.instances[0].object_to_world.inverse();
  int seen = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 48; ++x) {
      if (film.at(x, y).alpha < 1.0f || film.at(x, y).component == 0.0f) continue;
      ++seen;
      V3d p;
      to_object.multVecMatrix(V3d(film.at(x, y).position), p);
      const V3f expected = ramp_color(ramp, static_cast<float>(1.0 - p.length()));
      EXPECT_NEAR((film.at(x, y).albedo - expected).length(), 0.0f, 3e-3f);
    }
  EXPECT_GT(seen, 200);
}

}  // namespace
}  // namespace morsel::render

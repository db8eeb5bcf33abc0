// SPDX-License-Identifier: Apache-2.0
// Light that two strategies can find, where one of them is cut short: by limits of depth, by
// opacity, by flags of visibility. Whatever they are, all strategies have the same mean.
#include <gtest/gtest.h>

#include <array>

#include "renderer/integrator/render.h"
#include "renderer/material/surface_frame.h"
#include "tests/renderer/mean_of_film.h"
#include "tests/renderer/test_scenes.h"

namespace morsel::render {
namespace {

using namespace testing;

constexpr std::array kStrategies{DirectLighting::kMis, DirectLighting::kLightsOnly,
                                 DirectLighting::kBsdfOnly};

Mean mean_by(const Scene& scene, DirectLighting strategy) {
  RenderOptions options;
  options.direct_lighting = strategy;
  return mean_of(render(scene, options).film);
}

void expect_same_mean(const Mean& a, const Mean& b, double more = 0.0) {
  EXPECT_NEAR(a.value, b.value, 4.5 * std::hypot(a.error, b.error) + more * b.value);
}

// All strategies against the first, which is given back.
Mean expect_strategies_agree(const Scene& scene) {
  const Mean mis = mean_by(scene, DirectLighting::kMis);
  for (const DirectLighting strategy : kStrategies) {
    SCOPED_TRACE(static_cast<int>(strategy));
    expect_same_mean(mean_by(scene, strategy), mis);
  }
  return mis;
}

// A floor of the material under an emitting square of the second material, one above.
Scene floor_under_emitter(MaterialType floor) {
  Scene scene;
  add_material(scene, floor, V3f(0.7f), 0.4f);
  const std::uint32_t emitter = add_material(scene, MaterialType::kDiffuse, V3f(0.0f));
  scene.materials[emitter].emission = V3f(2.0f);
  add_mesh(scene, plane_mesh(50.0f), 0);
  add_mesh(scene, plane_mesh(1.0f, 1.0f), emitter);
  scene.camera.position = V3f(0, 0.8f, 2.5f);
  scene.camera.look_at = V3f(0.0f);
  scene.camera.vertical_fov = 10.0f;
  set_image(scene, 16, 16, 128, 0);
  return scene;
}

TEST(LightPaths, LimitsOfAKindOfBounceLeaveDirectLight) {
  for (const MaterialType type : {MaterialType::kDiffuse, MaterialType::kConductor}) {
    Scene scene = floor_under_emitter(type);
    add_constant_environment(scene, 0.3f);
    const double direct = mean_by(scene, DirectLighting::kMis).value;
    EXPECT_GT(direct, 0.1);
    scene.settings.max_depth = 5;
    scene.settings.max_diffuse_depth = scene.settings.max_glossy_depth = 0;
    EXPECT_EQ(expect_strategies_agree(scene).value, direct);
  }
}

// At the last bounce allowed, too.
TEST(LightPaths, TheLastBounceOfALimitSeesAllLight) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.5f));
  add_mesh(scene, plane_mesh(50.0f), 0);
  add_mesh(scene, sphere_mesh(3, true), 0, translated(0.0, 1.0, 0.0));
  add_constant_environment(scene, 1.0f);
  scene.camera.position = V3f(0, 2, 6);
  scene.camera.look_at = V3f(0, 0, 0.7f);
  scene.camera.vertical_fov = 2.0f;
  set_image(scene, 8, 8, 256, 1);
  const double one_bounce = mean_by(scene, DirectLighting::kMis).value;
  scene.settings.max_depth = 8;
  scene.settings.max_diffuse_depth = 1;
  EXPECT_NEAR(expect_strategies_agree(scene).value, one_bounce, 1e-6);
}

TEST(LightPaths, EmittersGlowByTheirOpacity) {
  Scene scene = floor_under_emitter(MaterialType::kDiffuse);
  Material& emitter = scene.materials[1];
  const Mean opaque = expect_strategies_agree(scene);
  emitter.opacity = 0.5f;
  const Mean half = expect_strategies_agree(scene);
  EXPECT_NEAR(half.value, 0.5 * opaque.value, 5.0 * std::hypot(half.error, opaque.error));
  emitter.opacity_cutoff = 0.6f;  // it is not there
  EXPECT_EQ(expect_strategies_agree(scene).value, 0.0);
  emitter.opacity_cutoff = 0.0f;
  emitter.opacity = 1.0f;
  emitter.vertex_alpha = true;
  std::get<TriangleMesh>(scene.geometries[1].shape).alphas = {0.5f, 0.5f, 0.5f, 0.5f};
  expect_same_mean(expect_strategies_agree(scene), half);
}

TEST(LightPaths, EmittersHiddenFromBouncesLightNothing) {
  Scene scene = floor_under_emitter(MaterialType::kDiffuse);
  scene.instances[1].visible_to_bounces = false;
  EXPECT_EQ(expect_strategies_agree(scene).value, 0.0);
  scene.instances[1].visible_to_bounces = true;
  scene.instances[1].visible_to_camera = scene.instances[1].casts_shadow = false;
  EXPECT_GT(expect_strategies_agree(scene).value, 0.1);
}

// White, partly there, in a white world.
TEST(LightPaths, PartlyOpaqueGlassMakesNoLight) {
  for (const float ior : {1.5f, 2.0f})
    for (const float roughness : {0.0f, 0.5f})
      for (const MaterialType type : {MaterialType::kDielectric, MaterialType::kPrincipled}) {
        Scene scene;
        Material& m = scene.materials[add_material(scene, type, V3f(1.0f), roughness)];
        m.ior = ior;
        m.transmission = 1.0f;
        m.opacity = 0.5f;
        add_mesh(scene, sphere_mesh(4, true), 0);
        add_constant_environment(scene, 1.0f);
        scene.camera.position = V3f(0, 0, 4);
        scene.camera.vertical_fov = 20.0f;
        set_image(scene, 16, 16, 64, 64);
        const Mean mean = mean_of(render(scene).film);
        EXPECT_NEAR(mean.value, 1.0, 0.012 + 4.0 * mean.error) << ior << " " << roughness;
      }
}

// A black body that lets half of the light by, which it then absorbs in part.
Scene half_opaque_absorber() {
  Scene scene;
  Material& m = scene.materials[add_material(scene, MaterialType::kPrincipled, V3f(0.0f))];
  m.specular = 0.0f;
  m.opacity = 0.5f;
  m.attenuation_distance = 1.0f;
  m.attenuation_color = V3f(0.5f);
  return scene;
}

TEST(LightPaths, WhatPassesThroughABodyIsAbsorbedByItAlone) {
  for (const float distance : {2.0f, 50.0f}) {
    Scene scene = half_opaque_absorber();
    add_mesh(scene, sphere_mesh(4, true), 0);
    add_constant_environment(scene, 1.0f);
    scene.camera.position = V3f(0, 0, distance);
    scene.camera.vertical_fov = 0.01f;
    set_image(scene, 8, 8, 512, 8);
    // Both surfaces let half through, and the way between them, two long, a quarter.
    const Mean mean = mean_of(render(scene).film);
    EXPECT_NEAR(mean.value, 0.0625, 5.0 * mean.error + 5e-4) << distance;
  }
}

TEST(LightPaths, LightSamplesAreAbsorbedOnTheirWay) {
  Scene scene = half_opaque_absorber();
  const std::uint32_t floor = add_material(scene, MaterialType::kDiffuse, V3f(0.8f));
  add_mesh(scene, sphere_mesh(3, true), 0, translated(0.0, 1.5, 0.0));
  add_mesh(scene, plane_mesh(50.0f), floor);
  SphereLight light;
  light.position = V3f(0, 6, 0);
  light.radius = 1.0f;
  light.radiance = V3f(20.0f);
  scene.spheres.push_back(light);
  scene.camera.position = V3f(3, 0.4f, 0);
  scene.camera.look_at = V3f(0.0f);
  scene.camera.vertical_fov = 2.0f;
  set_image(scene, 8, 8, 1024, 0);
  EXPECT_GT(expect_strategies_agree(scene).value, 0.005);
}

TEST(LightPaths, SphereLightsAreBlackInside) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(1.0f));
  add_mesh(scene, sphere_mesh(3, true), 0);
  SphereLight light;
  light.radius = 10.0f;
  scene.spheres.push_back(light);
  scene.camera.position = V3f(0, 0, 4);
  scene.camera.vertical_fov = 60.0f;
  set_image(scene, 16, 16, 16, 4);
  EXPECT_EQ(expect_strategies_agree(scene).value, 0.0);
  scene.camera.position = V3f(0, 0, 40);
  EXPECT_GT(mean_of(render(scene).film).value, 0.1);
}

// Alpha is what sees something, and a sun behind nothing is not seen.
TEST(LightPaths, DistantLightsLeaveTheSkyTransparent) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.5f));
  add_mesh(scene, plane_mesh(1.0f), 0);
  DistantLight sun;
  sun.angular_diameter = 0.5f;
  scene.distants.push_back(sun);
  scene.camera.position = V3f(0, 1, 3);
  scene.camera.look_at = V3f(0, 9, 0);
  set_image(scene, 4, 4, 4);
  EXPECT_EQ(render(scene).film.at(0, 0).alpha, 0.0f);
  add_constant_environment(scene, 0.0f);
  EXPECT_EQ(render(scene).film.at(0, 0).alpha, 1.0f);
}

// More surfaces than a path looks through count as a wall: there is none of the sky behind them.
TEST(LightPaths, TooManyCutOutsBlock) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.0f));
  scene.materials[0].opacity = 0.0f;
  const std::uint32_t black = add_material(scene, MaterialType::kDiffuse, V3f(0.0f));
  for (int i = 0; i < 300; ++i)
    add_mesh(scene, plane_mesh(5.0f, -0.01f * static_cast<float>(i)), 0);
  add_mesh(scene, plane_mesh(50.0f, -5.0f), black);
  add_constant_environment(scene, 1.0f);
  scene.camera.position = V3f(0, 3, 0.01f);
  scene.camera.look_at = V3f(0.0f);
  scene.camera.vertical_fov = 5.0f;
  set_image(scene, 4, 4, 4);
  EXPECT_EQ(mean_of(render(scene).film).value, 0.0);
}

// What textures go by on an instance that moves is where it is at the ray's time.
TEST(LightPaths, SurfaceFramesMoveWithTheInstance) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.5f));
  TriangleMesh plane = plane_mesh(1.0f);
  plane.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  add_mesh(scene, plane, 0);
  add_mesh(scene, plane, 0, rotated_y(90.0));
  scene.instances[0].object_to_world_end = rotated_y(90.0);
  SurfaceInteraction moving, still;
  moving.instance = 0;
  still.instance = 1;
  moving.geometry = still.geometry = 0;
  moving.primitive = still.primitive = 0;
  moving.time = 1.0f;
  const SurfaceFrame at_end = surface_frame(scene, moving, 0),
                     there = surface_frame(scene, still, 0);
  ASSERT_TRUE(there.valid());
  EXPECT_LT((at_end.u_tangent - there.u_tangent).length(), 1e-6f);
  EXPECT_LT((at_end.v_gradient - there.v_gradient).length(), 1e-6f);
  moving.time = 0.0f;
  EXPECT_GT((surface_frame(scene, moving, 0).u_tangent - there.u_tangent).length(), 0.5f);
}

}  // namespace
}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
// Whole renders with every kind of light and material against formulas and against each other.
#include <gtest/gtest.h>

#include <array>

#include "renderer/integrator/render.h"
#include "tests/renderer/mean_of_film.h"
#include "tests/renderer/test_scenes.h"

namespace morsel::render {
namespace {

using namespace testing;

std::uint32_t add_principled(Scene& scene, const V3f& color, float roughness = 0.5f) {
  return add_material(scene, MaterialType::kPrincipled, color, roughness);
}

// A small patch of the plane y = 0 about the origin.
void look_at_origin(Scene& scene) {
  scene.camera.position = V3f(0, 1, 3);
  scene.camera.look_at = V3f(0.0f);
  scene.camera.vertical_fov = 0.01f;
}

// E of a sphere light whose centre is above the horizon: pi L (r/d)^2 cos.
TEST(Lights, SphereGivesItsIrradiance) {
  for (const auto strategy :
       {DirectLighting::kMis, DirectLighting::kLightsOnly, DirectLighting::kBsdfOnly}) {
    Scene scene;
    add_material(scene, MaterialType::kDiffuse, V3f(0.6f));
    add_mesh(scene, plane_mesh(100.0f), 0);
    SphereLight light;
    light.position = V3f(1.0f, 2.0f, -0.5f);
    light.radius = 0.7f;
    light.radiance = V3f(4.0f);
    scene.spheres.push_back(light);
    look_at_origin(scene);
    set_image(scene, 8, 8, 256, 0);
    RenderOptions options;
    options.direct_lighting = strategy;
    const Mean m = mean_of(render(scene, options).film);
    const double d2 = 1.0 + 4.0 + 0.25, expected = 0.6 * 4.0 * 0.49 / d2 * 2.0 / std::sqrt(d2);
    EXPECT_NEAR(m.value, expected, 5.0 * m.error + 2e-3 * expected);
  }
}

Scene many_lights() {
  Scene scene;
  const auto ground = add_principled(scene, V3f(0.7f, 0.5f, 0.3f), 0.4f);
  add_mesh(scene, plane_mesh(50.0f), ground);
  const auto metal = add_material(scene, MaterialType::kConductor, V3f(0.9f), 0.4f);
  add_mesh(scene, sphere_mesh(3, true), metal, translated(-1.2, 1.0, -1.0));
  const auto lamp = add_principled(scene, V3f(0.2f));
  scene.materials[lamp].emission = V3f(2.0f, 1.0f, 0.5f);
  scene.materials[lamp].group = 0;
  scene.light_groups = {"lamps", "sky"};
  add_mesh(scene, sphere_mesh(2), lamp, scaled(0.4, 0.4, 0.4) * translated(1.5, 1.2, 0.3));
  DiskLight disk;
  disk.position = V3f(0, 3, 1);
  disk.normal = V3f(0, -1, 0);
  disk.radius = 0.8f;
  disk.radiance = V3f(2.0f);
  scene.disks.push_back(disk);
  SphereLight ball;
  ball.position = V3f(-2.5f, 0.6f, 1.0f);
  ball.radius = 0.3f;
  ball.radiance = V3f(6.0f);
  scene.spheres.push_back(ball);
  DistantLight sun;
  sun.direction = V3f(0.4f, -1.0f, -0.3f);
  sun.angular_diameter = 20.0f;
  sun.irradiance = V3f(0.5f);
  sun.group = 1;
  scene.distants.push_back(sun);
  add_constant_environment(scene, 0.1f);
  scene.environment->group = 1;
  add_rectangle(scene, V3f(2, 0.5f, -3), V3f(0, 0, 1), V3f(0, 1, 0), 3.0f);
  scene.camera.position = V3f(0, 2.5f, 6);
  scene.camera.look_at = V3f(0, 0.5f, 0);
  set_image(scene, 24, 16, 128, 2);
  return scene;
}

// Two images of the same scene with independent noise: their difference over its standard error.
double z_of(const Film& a, const Film& b) {
  const Mean x = mean_of(a), y = mean_of(b);
  return (x.value - y.value) / std::sqrt(x.error * x.error + y.error * y.error);
}

TEST(Lights, EveryStrategyHasTheSameMean) {
  Scene scene = many_lights();
  const RenderResult mis = render(scene);
  for (const auto strategy : {DirectLighting::kLightsOnly, DirectLighting::kBsdfOnly}) {
    scene.settings.seed = 1 + static_cast<std::uint32_t>(strategy);
    RenderOptions options;
    options.direct_lighting = strategy;
    const RenderResult other = render(scene, options);
    EXPECT_LT(std::abs(z_of(mis.film, other.film)), 4.0);
    EXPECT_EQ(other.statistics.non_finite_samples, 0u);
  }
}

TEST(Lights, RussianRouletteIsUnbiased) {
  // All of the light comes by way of many dim bounces.
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.6f));
  add_mesh(scene, sphere_mesh(6), 0, scaled(4, 4, 4));
  add_rectangle(scene, V3f(-0.01f, 0, -0.01f), V3f(0.02f, 0, 0), V3f(0, 0, 0.02f), 25000.0f);
  scene.camera.position = V3f(0, 1, 0);
  scene.camera.look_at = V3f(0, 4, 0);
  scene.camera.up = V3f(0, 0, 1);
  scene.camera.vertical_fov = 30.0f;  // a part that the light does not reach directly
  set_image(scene, 16, 16, 128, 60);
  const Mean m = mean_of(render(scene).film);
  // In a sphere every point lights every other alike: the series of 0.6^k; the light covers almost
  // nothing of it, and the triangles' sphere is 0.02 % smaller.
  const double flux = kPi * 10.0, area = 4.0 * kPi * 16.0;
  const double once = 0.6 * 0.6 * flux / area / kPi, all = once / (1.0 - 0.6);
  EXPECT_NEAR(m.value, all, 4.0 * m.error + 5e-4 * all);
}

TEST(Lights, VisibilityFlags) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.5f));
  add_mesh(scene, plane_mesh(100.0f), 0);
  add_mesh(scene, plane_mesh(100.0f, 0.5f), 0);  // covers everything
  add_constant_environment(scene, 1.0f);
  look_at_origin(scene);
  set_image(scene, 4, 4, 64, 0);
  scene.instances[1].visible_to_camera = false;
  EXPECT_NEAR(mean_of(render(scene).film).value, 0.0, 1e-6);
  scene.instances[1].casts_shadow = false;
  scene.instances[1].visible_to_bounces = false;
  const Mean m = mean_of(render(scene).film);
  EXPECT_NEAR(m.value, 0.5, 4.0 * m.error + 1e-4);
}

// Half a cover lets half of the light through, to the camera and to shadow rays.
TEST(Opacity, LetsItsShareOfLightThrough) {
  for (const float opacity : {0.0f, 0.3f, 1.0f}) {
    Scene scene;
    add_material(scene, MaterialType::kDiffuse, V3f(0.5f));
    add_mesh(scene, plane_mesh(100.0f), 0);
    const auto cover = add_principled(scene, V3f(0.0f));
    scene.materials[cover].specular = 0.0f;
    scene.materials[cover].opacity = opacity;
    add_mesh(scene, plane_mesh(100.0f, 0.5f), cover);
    DistantLight sun;
    sun.irradiance = V3f(1.0f);
    scene.distants.push_back(sun);
    look_at_origin(scene);
    set_image(scene, 16, 16, 64, 0);
    const Mean m = mean_of(render(scene).film);
    const double expected = square(1.0f - opacity) * 0.5 * kInvPi;
    EXPECT_NEAR(m.value, expected, 4.0 * m.error + 1e-5);
  }
}

// A slab of clear glass of index 1 absorbs by Beer's law.
// Its colour tints what passes where the material says so, as those of glTF do.
TEST(Absorption, FollowsBeersLaw) {
  for (const bool tints : {false, true}) {
    Scene scene;
    const auto ink = add_material(scene, MaterialType::kDielectric, V3f(0.4f));
    scene.materials[ink].ior = 1.0f;
    scene.materials[ink].attenuation_distance = 0.5f;
    scene.materials[ink].attenuation_color = V3f(0.25f);
    scene.materials[ink].color_tints_volume = tints;
    add_mesh(scene, sphere_mesh(5), ink);
    add_constant_environment(scene, 1.0f);
    scene.camera.position = V3f(0, 0, 5);
    scene.camera.vertical_fov = 0.01f;
    set_image(scene, 2, 2, 16, 8);
    const Mean m = mean_of(render(scene).film);
    const double way = std::pow(0.25, 2.0 / 0.5);
    EXPECT_NEAR(m.value, tints ? 0.4 * way : way, 2e-4);
  }
}

// In a closed white box with emitting walls radiance is the same everywhere: L = E / (1 - albedo).
TEST(Furnace, EmittingWallsFillABoxWithEvenLight) {
  for (const bool principled : {false, true}) {
    Scene scene;
    const auto wall = add_material(
        scene, principled ? MaterialType::kPrincipled : MaterialType::kDiffuse, V3f(0.5f), 0.3f);
    scene.materials[wall].specular = 0.0f;
    scene.materials[wall].emission = V3f(1.0f);
    add_mesh(scene, sphere_mesh(2), wall, scaled(3, 3, 3));
    scene.camera.position = V3f(0.5f, 0, 0);
    set_image(scene, 8, 8, 128, 40);
    const Mean m = mean_of(render(scene).film);
    EXPECT_NEAR(m.value, 2.0, 4.0 * m.error + 2e-3);
  }
}

TEST(LightGroups, AddUpToTheImage) {
  Scene scene = many_lights();
  const Film some = render(scene).film;
  ASSERT_EQ(some.group_count(), 2u);
  scene.light_groups.emplace_back("rest");  // then no light is in none
  scene.disks[0].group = scene.spheres[0].group = scene.rectangles[0].group = 2;
  const Film all = render(scene).film;
  ASSERT_EQ(all.group_count(), 3u);
  std::array<double, 3> light{};
  for (int y = 0; y < all.height(); ++y)
    for (int x = 0; x < all.width(); ++x) {
      const V3f color = all.at(x, y).color;
      EXPECT_EQ(color, some.at(x, y).color);
      V3f sum(0.0f);
      for (std::size_t g = 0; g < 3; ++g) {
        sum += all.group(g, x, y);
        light[g] += all.group(g, x, y).x;
        if (g < 2) {
          EXPECT_EQ(all.group(g, x, y), some.group(g, x, y));
        }
      }
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], color[c], 1e-4f * color[c] + 1e-5f);
    }
  for (const double one : light) EXPECT_GT(one, 0.0);
}

TEST(Clamp, TakesLightAwayAndNeverDirectLight) {
  Scene scene = many_lights();
  scene.settings.max_depth = 4;
  const Mean all = mean_of(render(scene).film);
  scene.settings.indirect_clamp = 0.01f;
  const Mean clamped = mean_of(render(scene).film);
  EXPECT_LT(clamped.value, all.value);
  scene.settings.max_depth = 0;
  const Mean clamped_direct = mean_of(render(scene).film);
  scene.settings.indirect_clamp = 0.0f;
  EXPECT_EQ(mean_of(render(scene).film).value, clamped_direct.value);
}

TEST(DepthLimits, ByKindOfBounce) {
  Scene scene = many_lights();
  scene.settings.max_depth = 6;
  const double all = mean_of(render(scene).film).value;
  scene.settings.max_diffuse_depth = 0;
  const double no_diffuse = mean_of(render(scene).film).value;
  scene.settings.max_glossy_depth = 0;
  const double direct = mean_of(render(scene).film).value;
  EXPECT_LT(no_diffuse, all);
  EXPECT_LT(direct, no_diffuse);
}

// The mean does not depend on when pixels stop: against a render with all samples.
TEST(AdaptiveSampling, IsUnbiasedAndSavesSamples) {
  Scene scene = many_lights();
  scene.settings.width = 48;
  scene.settings.height = 32;
  scene.settings.spp = 128;
  const RenderResult all = render(scene);
  scene.settings.seed = 77;
  scene.settings.noise_target = 0.2f;
  scene.settings.min_spp = 8;
  const RenderResult adaptive = render(scene);
  EXPECT_LT(adaptive.statistics.samples, all.statistics.samples / 2);
  // By the scatter of the pixels' differences: an adaptive pixel's own variance is an estimate that
  // depends on when it stopped.
  double sum = 0.0, squares = 0.0;
  const double n = 48.0 * 32.0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 48; ++x) {
      const double d = luminance(adaptive.film.at(x, y).color) - luminance(all.film.at(x, y).color);
      sum += d / n;
      squares += d * d / n;
    }
  EXPECT_LT(std::abs(sum), 4.0 * std::sqrt(squares / n));
  std::uint32_t least = ~0u, most = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 48; ++x) {
      least = std::min(least, adaptive.film.at(x, y).samples);
      most = std::max(most, adaptive.film.at(x, y).samples);
    }
  EXPECT_LT(least, most);
}

TEST(AdaptiveSampling, DoesNotDependOnCropAndThreads) {
  Scene scene = many_lights();
  scene.settings.spp = 64;
  scene.settings.noise_target = 0.1f;
  scene.settings.cryptomatte = true;
  scene.settings.filter = PixelFilter::kGaussian;
  scene.settings.filter_radius = 1.5f;
  RenderOptions options;
  options.threads = 1;
  const Film whole = render(scene, options).film;
  scene.settings.crop = Crop{5, 3, 20, 12};
  options.threads = 4;
  const Film crop = render(scene, options).film;
  for (int y = 3; y < 12; ++y)
    for (int x = 5; x < 20; ++x) {
      EXPECT_EQ(whole.at(x, y).color, crop.at(x, y).color);
      EXPECT_EQ(whole.at(x, y).samples, crop.at(x, y).samples);
      EXPECT_EQ(whole.group(0, x, y), crop.group(0, x, y));
      EXPECT_EQ(whole.matte(0, x, y)[0].id, crop.matte(0, x, y)[0].id);
    }
}

// A bright disk seen through a lens: where it is sharp its edge is, and out of focus it spreads,
// but the image's mean stays.
TEST(ThinLens, BlursWhatIsOutOfFocusAndKeepsTheLight) {
  const auto image = [](float aperture, float focus, int blades) {
    Scene scene;
    add_material(scene, MaterialType::kDiffuse, V3f(0.0f));
    add_rectangle(scene, V3f(-0.25f, -0.25f, 0), V3f(0.5f, 0, 0), V3f(0, 0.5f, 0), 1.0f);
    scene.camera.position = V3f(0, 0, 5);
    scene.camera.vertical_fov = 25.0f;
    scene.camera.aperture_radius = aperture;
    scene.camera.focus_distance = focus;
    scene.camera.blades = blades;
    set_image(scene, 32, 32, 256, 0);
    return render(scene).film;
  };
  const auto sum = [](const Film& f) { return mean_of(f).value * 1024.0; };
  const Film pinhole = image(0.0f, 0.0f, 0), sharp = image(0.2f, 5.0f, 0);
  const Film blurred = image(0.2f, 2.5f, 0), hexagon = image(0.2f, 2.5f, 6);
  EXPECT_NEAR(sum(sharp), sum(pinhole), 0.01 * sum(pinhole));
  EXPECT_NEAR(sum(blurred), sum(pinhole), 0.03 * sum(pinhole));
  EXPECT_NEAR(sum(hexagon), sum(pinhole), 0.03 * sum(pinhole));
  EXPECT_NEAR(sharp.at(16, 16).color.x, 1.0f, 1e-3f);
  EXPECT_LT(blurred.at(13, 13).color.x, 0.98f);
  EXPECT_EQ(sharp.at(8, 16).color.x, 0.0f);
  EXPECT_GT(blurred.at(11, 16).color.x, 0.0f);
}

// A moving emitter smears evenly along its way; the shutter decides how far.
TEST(MotionBlur, AnInstanceGoesWhereItIsSent) {
  Scene scene;
  add_material(scene, MaterialType::kPrincipled, V3f(0.0f));
  scene.materials[0].emission = V3f(1.0f);
  scene.materials[0].specular = 0.0f;
  add_mesh(scene, sphere_mesh(3), 0, scaled(0.2, 0.2, 0.2) * translated(-1, 0, 0));
  scene.instances[0].object_to_world_end = scaled(0.2, 0.2, 0.2) * translated(1, 0, 0);
  scene.camera.projection = Projection::kOrthographic;
  scene.camera.height = 3.0f;
  set_image(scene, 60, 60, 256, 0);
  const auto centre = [&](float open, float close) {
    scene.camera.shutter_open = open;
    scene.camera.shutter_close = close;
    const Film f = render(scene).film;
    double x_sum = 0.0, total = 0.0;
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 60; ++x) {
        total += f.at(x, y).color.x;
        x_sum += f.at(x, y).color.x * ((x + 0.5) / 60.0 * 3.0 - 1.5);
      }
    // Its disk's area, however it moved.
    EXPECT_NEAR(total * 9.0 / 3600.0, kPi * 0.04, 0.03 * kPi * 0.04);
    return x_sum / total;
  };
  EXPECT_NEAR(centre(0.0f, 0.0f), -1.0, 0.01);
  EXPECT_NEAR(centre(0.0f, 1.0f), 0.0, 0.03);
  EXPECT_NEAR(centre(0.5f, 1.0f), 0.5, 0.03);
}

}  // namespace
}  // namespace morsel::render

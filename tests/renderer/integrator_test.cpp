// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <regex>
#include <stdexcept>
#include <tuple>

#include "renderer/integrator/render.h"
#include "tests/renderer/mean_of_film.h"
#include "tests/renderer/statistics.h"
#include "tests/renderer/test_scenes.h"

namespace morsel::render {
namespace {

using namespace testing;

// All pixels see the unit sphere at the origin.
void look_at_sphere(Scene& scene) {
  scene.camera.position = V3f(0, 0, 4);
  scene.camera.vertical_fov = 20.0f;
}

TEST(Furnace, ConvexDiffuseBodyReflectsItsAlbedo) {
  for (const float albedo : {1.0f, 0.5f, 0.0f})
    for (const bool smooth : {false, true}) {
      Scene scene;
      add_material(scene, MaterialType::kDiffuse, V3f(albedo));
      add_mesh(scene, sphere_mesh(4, smooth), 0);
      add_constant_environment(scene, 1.0f);
      look_at_sphere(scene);
      set_image(scene, 16, 16, 64);
      const RenderResult result = render(scene);
      // Interpolated normals lose a little along the silhouette.
      const double tolerance = smooth ? 0.01 : 1e-4;
      const Mean m = mean_of(result.film);
      EXPECT_NEAR(m.value, albedo, 4.0 * m.error + tolerance) << smooth;
      EXPECT_EQ(result.statistics.non_finite_samples, 0u);
      if (!smooth)
        for (int y = 0; y < 16; ++y)
          for (int x = 0; x < 16; ++x) {
            const Pixel& p = result.film.at(x, y);
            EXPECT_NEAR(p.color.x, albedo, 6.0f * std::sqrt(p.variance.x) + 1e-3f);
          }
    }
}

TEST(Furnace, MetalOfReflectanceOneVanishes) {
  for (const float roughness : {0.0f, 0.3f, 0.7f, 1.0f}) {
    Scene scene;
    add_material(scene, MaterialType::kConductor, V3f(1.0f), roughness);
    add_mesh(scene, sphere_mesh(4), 0);
    add_constant_environment(scene, 1.0f);
    look_at_sphere(scene);
    set_image(scene, 16, 16, 64);
    const Mean m = mean_of(render(scene).film);
    EXPECT_NEAR(m.value, 1.0, 4.0 * m.error + 0.01) << roughness;
  }
}

TEST(Furnace, ClearGlassVanishes) {
  for (const float roughness : {0.0f, 0.15f}) {
    Scene scene;
    add_material(scene, MaterialType::kDielectric, V3f(1.0f), roughness);
    add_mesh(scene, sphere_mesh(4), 0);
    add_constant_environment(scene, 1.0f);
    look_at_sphere(scene);
    set_image(scene, 16, 16, 64, 64);
    const RenderResult result = render(scene);
    const Mean m = mean_of(result.film);
    EXPECT_NEAR(m.value, 1.0, 4.0 * m.error + (roughness > 0.0f ? 0.02 : 2e-3)) << roughness;
    EXPECT_EQ(result.statistics.non_finite_samples, 0u);
  }
}

// Between two parallel walls of albedo a, one bounce more brings a times more: the inside of a
// closed diffuse sphere that emits nowhere, seen with a light inside, is checked against the
// geometric series by way of max_depth.
TEST(PathTracer, DepthLimitsTheNumberOfBounces) {
  // Inside a white-ish sphere with a small light at the centre facing down: every bounce multiplies
  // the light's indirect part by the albedo.
  double last = 0.0, step = 0.0;
  for (int depth = 0; depth <= 3; ++depth) {
    Scene scene;
    add_material(scene, MaterialType::kDiffuse, V3f(0.5f));
    add_mesh(scene, sphere_mesh(4), 0, scaled(4, 4, 4));
    add_rectangle(scene, V3f(-0.05f, 0, -0.05f), V3f(0.1f, 0, 0), V3f(0, 0, 0.1f), 100.0f);
    scene.camera.position = V3f(0, 1, 0);
    scene.camera.look_at = V3f(0, 4, 0);  // a part that the light does not reach directly
    scene.camera.up = V3f(0, 0, 1);
    scene.camera.vertical_fov = 30.0f;
    set_image(scene, 16, 16, 256, depth);
    const Mean m = mean_of(render(scene).film);
    if (depth == 0) {
      EXPECT_EQ(m.value, 0.0);
    } else if (depth == 1) {
      // In a sphere every point lights every other alike: E = flux / area of the sphere, the
      // flux being pi * radiance * area of the light.
      const double flux = kPi * 100.0 * 0.01, area = 4.0 * kPi * 16.0;
      step = 0.5 * 0.5 * flux / area / kPi;
      EXPECT_NEAR(m.value, step, 4.0 * m.error + 0.01 * step);
    } else {
      EXPECT_NEAR(m.value - last, step * std::pow(0.5, depth - 1), 6.0 * m.error + 0.01 * step);
    }
    last = m.value;
  }
}

// Form factor of a parallel rectangle with a corner straight above the point, x and y being its
// sides over its height (any radiation textbook; e.g. Howell's catalogue, B-3).
double corner_form_factor(double x, double y) {
  const double a = std::sqrt(1.0 + x * x), b = std::sqrt(1.0 + y * y);
  return (x / a * std::atan(y / a) + y / b * std::atan(x / b)) / (2.0 * 3.14159265358979323846);
}

class Lighting : public ::testing::TestWithParam<DirectLighting> {};

TEST_P(Lighting, RectangleGivesTheIrradianceOfItsFormFactor) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.6f));
  add_mesh(scene, plane_mesh(100.0f), 0);
  // Seen from the origin: corners at x = -1 and 3, z = -2 and 0.5, height 2.
  add_rectangle(scene, V3f(-1, 2, -2), V3f(4, 0, 0), V3f(0, 0, 2.5f), 5.0f);
  scene.camera.position = V3f(0, 1, 3);
  scene.camera.vertical_fov = 0.1f;
  set_image(scene, 4, 4, 4096, 0);
  RenderOptions options;
  options.direct_lighting = GetParam();
  const Mean m = mean_of(render(scene, options).film);
  const double form = corner_form_factor(0.5, 1.0) + corner_form_factor(1.5, 1.0) +
                      corner_form_factor(0.5, 0.25) + corner_form_factor(1.5, 0.25);
  EXPECT_NEAR(m.value, 0.6 * 5.0 * form, 4.0 * m.error + 1e-3);
  EXPECT_LT(m.error, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Strategies, Lighting,
                         ::testing::Values(DirectLighting::kMis, DirectLighting::kLightsOnly,
                                           DirectLighting::kBsdfOnly));

// Everything at once: diffuse floor, rough metal, rough glass, an environment, a rectangle.
Scene mixed_scene() {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.7f, 0.6f, 0.5f));
  add_material(scene, MaterialType::kConductor, V3f(0.9f, 0.7f, 0.4f), 0.4f);
  add_material(scene, MaterialType::kDielectric, V3f(0.9f), 0.5f);
  scene.materials[0].checker_color = V3f(0.2f);
  add_mesh(scene, plane_mesh(6.0f, -1.0f), 0);
  add_mesh(scene, sphere_mesh(3, true), 1, translated(-1.2, 0, 0));
  add_mesh(scene, sphere_mesh(3, true), 2, translated(1.2, 0, 0));
  add_constant_environment(scene, 0.3f);
  add_rectangle(scene, V3f(-1, 3, -1), V3f(2, 0, 0), V3f(0, 0, 2), 8.0f);
  scene.camera.position = V3f(0, 2, 6);
  scene.camera.vertical_fov = 35.0f;
  set_image(scene, 48, 32, 64, 4);
  return scene;
}

TEST(Mis, HasTheMeanOfEachStrategy) {
  Scene scene = mixed_scene();
  scene.settings.spp = 256;
  Mean means[3];
  RenderOptions options;
  int i = 0;
  for (const DirectLighting strategy :
       {DirectLighting::kMis, DirectLighting::kLightsOnly, DirectLighting::kBsdfOnly}) {
    options.direct_lighting = strategy;
    scene.settings.seed = static_cast<std::uint32_t>(i);
    means[i++] = mean_of(render(scene, options).film);
  }
  for (int k = 1; k < 3; ++k)
    EXPECT_LT(std::abs(means[k].value - means[0].value),
              4.0 * std::hypot(means[k].error, means[0].error))
        << k << ": " << means[k].value << " against " << means[0].value;
  EXPECT_LT(means[0].error, means[2].error);
  EXPECT_LT(means[0].error, 0.01 * means[0].value);
}

void expect_identical(const Pixel& a, const Pixel& b, int x, int y) {
  const auto all = [](const Pixel& p) {
    return std::tuple(p.color, p.alpha, p.albedo, p.normal, p.variance, p.depth, p.component,
                      p.samples);
  };
  ASSERT_EQ(all(a), all(b)) << x << ", " << y;
}

TEST(Determinism, ThreadsAndCropChangeNoPixel) {
  Scene scene = mixed_scene();
  scene.settings.spp = 8;
  scene.settings.width = 100;
  scene.settings.height = 70;
  RenderOptions one, two;
  one.threads = 1;
  two.threads = 2;
  const RenderResult a = render(scene, one);
  const RenderResult b = render(scene, two);
  scene.settings.crop = Crop{13, 22, 87, 69};
  const RenderResult c = render(scene, two);
  for (int y = 0; y < 70; ++y)
    for (int x = 0; x < 100; ++x) {
      expect_identical(a.film.at(x, y), b.film.at(x, y), x, y);
      if (x >= 13 && x < 87 && y >= 22 && y < 69)
        expect_identical(a.film.at(x, y), c.film.at(x, y), x, y);
    }
  EXPECT_EQ(a.statistics.rays.total(), b.statistics.rays.total());
  EXPECT_EQ(a.statistics.samples, 100u * 70u * 8u);
  EXPECT_EQ(a.statistics.rays.camera, a.statistics.samples);
}

TEST(Features, OfTheFirstSurfaceThatScatters) {
  Scene scene = mixed_scene();
  scene.materials[1].roughness = 0.0f;  // a mirror
  scene.materials[2] = scene.materials[1];
  scene.materials[2].type = MaterialType::kDielectric;
  scene.settings.spp = 1;
  const RenderResult result = render(scene);
  // Top left: the sky. Bottom: the floor, 3 below the camera.
  const Pixel& sky = result.film.at(0, 0);
  EXPECT_EQ(sky.depth, kFarDepth);
  EXPECT_EQ(sky.alpha, 1.0f);
  EXPECT_EQ(sky.normal, V3f(0.0f));
  EXPECT_NEAR(sky.color.x, 0.3f, 1e-6f);
  const Pixel& floor = result.film.at(24, 31);
  EXPECT_EQ(floor.normal, V3f(0, 1, 0));
  EXPECT_TRUE(floor.albedo == V3f(0.2f) || floor.albedo == V3f(0.7f, 0.6f, 0.5f));
  // Depth is along the axis: a plane through the camera's look-at point at right angles to the view
  // is at |position - look_at| everywhere; here simply compare with the geometry.
  EXPECT_GT(floor.depth, 3.0f);
  EXPECT_LT(floor.depth, 7.0f);
  // The mirror shows the floor's or the sky's features, not its own.
  int floor_in_mirror = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 6; x < 20; ++x) {
      const Pixel& p = result.film.at(x, y);
      EXPECT_TRUE(p.normal == V3f(0, 1, 0) || p.normal == V3f(0.0f) || p.normal == V3f(0, -1, 0) ||
                  p.normal == V3f(0, 1, 0))
          << p.normal;
      floor_in_mirror += p.depth < 5.7f && p.normal == V3f(0, 1, 0);
    }
  EXPECT_GT(floor_in_mirror, 5);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 48; ++x) {
      EXPECT_LE(max_component(result.film.at(x, y).albedo), 1.0f);
      EXPECT_EQ(result.film.at(x, y).component, 0.0f);
    }
}

TEST(Features, DepthIsAlongTheCamerasAxis) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.5f));
  add_mesh(scene, plane_mesh(100.0f), 0);
  scene.camera.position = V3f(0, 3, 0);
  scene.camera.up = V3f(0, 0, 1);
  scene.camera.vertical_fov = 90.0f;
  set_image(scene, 16, 8, 4);
  const RenderResult result = render(scene);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x) {
      EXPECT_NEAR(result.film.at(x, y).depth, 3.0f, 1e-5f);
      EXPECT_EQ(result.film.at(x, y).color, V3f(0.0f));  // no lights at all: black, not NaN
    }
}

// Widening lobes blurs light, it must not lose or make any that matters: a white metal in a white
// furnace stays white, and what the camera sees directly is not touched.
TEST(Regularization, KeepsEnergyAndDirectViews) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(1.0f));
  add_material(scene, MaterialType::kConductor, V3f(1.0f), 0.05f);
  add_mesh(scene, plane_mesh(3.0f, -1.0f), 0);
  add_mesh(scene, sphere_mesh(4), 1);
  add_constant_environment(scene, 1.0f);
  scene.camera.position = V3f(0, 2, 5);
  set_image(scene, 32, 32, 64, 64);
  for (const float share : {0.0f, 0.25f, 1.0f}) {
    scene.settings.regularization = share;
    const Mean m = mean_of(render(scene).film);
    EXPECT_NEAR(m.value, 1.0, 4.0 * m.error + 0.01) << share;
  }
  // Only metal: nothing is seen by way of anything rougher.
  scene.instances.erase(scene.instances.begin());
  scene.settings.spp = 4;
  scene.settings.regularization = 0.0f;
  const RenderResult exact = render(scene);
  scene.settings.regularization = 1.0f;
  const RenderResult widened = render(scene);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) EXPECT_EQ(exact.film.at(x, y).color, widened.film.at(x, y).color);
}

TEST(Regularization, MakesCausticsCalmer) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.5f));
  add_material(scene, MaterialType::kConductor, V3f(0.9f), 0.1f);
  add_mesh(scene, plane_mesh(6.0f, -1.0f), 0);
  add_mesh(scene, sphere_mesh(3, true), 1);
  add_rectangle(scene, V3f(-3, 3, -0.2f), V3f(0.4f, 0.4f, 0), V3f(0, 0, 0.4f), 100.0f);
  scene.camera.position = V3f(-2.5f, 1, 4);
  scene.camera.look_at = V3f(-1.5f, -1, 0);
  scene.camera.vertical_fov = 20.0f;
  set_image(scene, 32, 32, 64);
  scene.settings.regularization = 0.0f;
  const Mean exact = mean_of(render(scene).film);
  scene.settings.regularization = 0.25f;
  const Mean calm = mean_of(render(scene).film);
  EXPECT_LT(calm.error, 0.7 * exact.error);
  EXPECT_NEAR(calm.value, exact.value, 0.1 * exact.value + 4.0 * exact.error);
}

TEST(Visibility, LightsAndEnvironmentCanHideFromTheCameraButStillShine) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.5f));
  add_mesh(scene, plane_mesh(1.0f), 0);
  add_rectangle(scene, V3f(-1, 1.2f, -1), V3f(2, 0, 0), V3f(0, 0, 2), 4.0f);
  add_constant_environment(scene, 1.0f);
  scene.camera.position = V3f(0, 0.6f, 5);
  scene.camera.look_at = V3f(0, 0.6f, 0);
  set_image(scene, 32, 32, 4);
  const auto brightest = [](const RenderResult& r, int y0, int y1) {
    float b = 0.0f;
    for (int y = y0; y < y1; ++y)
      for (int x = 0; x < 32; ++x) b = std::max(b, r.film.at(x, y).color.x);
    return b;
  };
  scene.camera.position = V3f(0, 0.3f, 5);  // sees the light from below, the floor from above
  const RenderResult visible = render(scene);
  EXPECT_EQ(visible.film.at(0, 0).alpha, 1.0f);
  EXPECT_GT(brightest(visible, 0, 16), 3.9f);
  scene.rectangles[0].visible_to_camera = false;
  scene.environment->visible_to_camera = false;
  const RenderResult hidden = render(scene);
  EXPECT_EQ(hidden.film.at(0, 0).alpha, 0.0f);
  EXPECT_EQ(hidden.film.at(0, 0).color, V3f(0.0f));
  EXPECT_EQ(brightest(hidden, 0, 16), 0.0f);
  EXPECT_GT(brightest(hidden, 16, 32), 1.0f);
}

// What a surface of this colour brings is found, whichever channel it is in: lights are skipped
// when they are black only.
TEST(Render, NanIsReportedWithPixelAndBounceInEveryChannel) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const V3f& bad : {V3f(kNan, 0, 0), V3f(0, kNan, 0), V3f(0, 0, kNan)})
    for (const bool in_light : {false, true}) {
      Scene scene;
      add_material(scene, MaterialType::kDiffuse, in_light ? V3f(0.5f) : bad);
      add_mesh(scene, sphere_mesh(3), 0);
      if (in_light) {
        add_rectangle(scene, V3f(-1, -1, 3), V3f(0, 2, 0), V3f(2, 0, 0), 1.0f);
        scene.rectangles[0].radiance = bad;
      } else {
        add_constant_environment(scene, 1.0f);
      }
      look_at_sphere(scene);
      if (in_light) scene.camera.position = V3f(0, 2, 4);
      set_image(scene, 16, 16, 4);
      const RenderResult result = render(scene);
      const auto& places = result.statistics.non_finite_places;
      ASSERT_FALSE(places.empty()) << bad << ", in a light: " << in_light;
      EXPECT_EQ(places.size(), std::min<std::uint64_t>(result.statistics.non_finite_samples,
                                                       NonFiniteReport::kMost));
      EXPECT_TRUE(std::is_sorted(places.begin(), places.end()));
      for (const NonFinitePlace& place : places) EXPECT_EQ(place.bounce, 1u);
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) ASSERT_TRUE(is_finite(result.film.at(x, y).color));

      RenderOptions options;
      options.stop_at_non_finite = true;
      try {
        render(scene, options);
        ADD_FAILURE() << "not stopped";
      } catch (const std::runtime_error& e) {
        const std::regex place("pixel [0-9]+,[0-9]+, sample [0-3], after bounce 1");
        EXPECT_TRUE(std::regex_search(e.what(), place)) << e.what();
      }
    }
}

// The same places whatever the threads; the samples that decide how many there shall be report too.
TEST(Render, ReportedPlacesDoNotDependOnThreads) {
  Scene scene = mixed_scene();
  scene.settings.spp = 8;
  scene.settings.noise_target = 0.1f;
  scene.rectangles[0].radiance = V3f(3e38f);
  scene.environment->radiance = V3f(3e38f);
  RenderOptions options;
  options.threads = 1;
  const auto one = render(scene, options).statistics.non_finite_places;
  options.threads = 2;
  EXPECT_EQ(one, render(scene, options).statistics.non_finite_places);
  EXPECT_EQ(one.size(), NonFiniteReport::kMost);
}

// Light beyond what float holds: the sums overflow, and no pixel shows it.
TEST(Render, NonFiniteSamplesAreCountedAndNeverWritten) {
  Scene scene = mixed_scene();
  scene.settings.spp = 4;
  scene.rectangles[0].radiance = V3f(3e38f);
  scene.environment->radiance = V3f(3e38f);
  const RenderResult result = render(scene);
  EXPECT_GT(result.statistics.non_finite_samples, 0u);
  EXPECT_LT(result.statistics.non_finite_samples, result.statistics.samples);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 48; ++x) {
      const Pixel& p = result.film.at(x, y);
      ASSERT_TRUE(is_finite(p.color) && is_finite(p.variance) && is_finite(p.albedo) &&
                  is_finite(p.normal) && std::isfinite(p.depth))
          << x << ", " << y;
    }
}

TEST(Render, CanBeCancelledAndReportsProgress) {
  Scene scene = mixed_scene();
  scene.settings.spp = 2;
  std::vector<double> fractions;
  RenderOptions options;
  options.threads = 2;
  options.progress = [&](double f) { fractions.push_back(f); };
  EXPECT_FALSE(render(scene, options).cancelled());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  ASSERT_FALSE(fractions.empty());
  EXPECT_EQ(fractions.back(), 1.0);

  std::atomic<bool> cancel{true};
  options.cancel = &cancel;
  const RenderResult result = render(scene, options);
  EXPECT_TRUE(result.cancelled());
  EXPECT_EQ(result.statistics.samples, 0u);
  EXPECT_EQ(result.film.at(0, 0).samples, 0u);
}

TEST(Render, RefusesWhatCannotBeRendered) {
  const Scene good = mixed_scene();
  const auto refused = [](const Scene& scene) {
    EXPECT_THROW(render(scene), std::invalid_argument);
  };
  Scene scene = good;
  scene.settings.spp = 0;
  refused(scene);
  scene = good;
  scene.settings.width = 0;
  refused(scene);
  scene = good;
  scene.settings.crop = Crop{0, 0, 49, 10};
  refused(scene);
  scene.settings.crop = Crop{5, 5, 5, 10};
  refused(scene);
  scene = good;
  scene.camera.look_at = scene.camera.position;
  refused(scene);
  scene = good;
  scene.camera.vertical_fov = 180.0f;
  refused(scene);
  scene = good;
  scene.environment->file = "/nowhere/sky.exr";
  EXPECT_THROW(render(scene), std::runtime_error);
}

}  // namespace
}  // namespace morsel::render

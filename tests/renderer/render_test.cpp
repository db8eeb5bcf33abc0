// SPDX-License-Identifier: Apache-2.0
// What render() promises whatever it renders: the same pixels, reports, cancellation, refusals.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <regex>
#include <stdexcept>
#include <tuple>

#include "renderer/integrator/render.h"
#include "renderer/integrator/trace_pixel.h"
#include "tests/renderer/test_scenes.h"

namespace morsel::render {
namespace {

using namespace testing;

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

// Lobes whose densities are no numbers end no path in silence.
TEST(Render, NanInALobesDensityIsReported) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const auto expect_reported = [](const char* what, MaterialType type, auto&& set) {
    Scene scene;
    add_material(scene, type, V3f(0.5f), 0.4f);
    set(scene.materials[0]);
    add_mesh(scene, sphere_mesh(3), 0);
    add_constant_environment(scene, 1.0f);
    look_at_sphere(scene);
    set_image(scene, 8, 8, 4);
    RenderOptions options;
    options.direct_lighting = DirectLighting::kBsdfOnly;  // light samples would show it, too
    const RenderResult result = render(scene, options);
    EXPECT_EQ(result.statistics.non_finite_samples, result.statistics.samples) << what;
  };
  const auto rough = [](Material& m) { m.roughness = kNan; };
  expect_reported("metal", MaterialType::kConductor, rough);
  expect_reported("glass", MaterialType::kDielectric, rough);
  expect_reported("metallic", MaterialType::kPrincipled, [](Material& m) {
    m.metallic = 1.0f;
    m.roughness = kNan;
  });
  expect_reported("a share", MaterialType::kPrincipled, [](Material& m) { m.metallic = kNan; });
  expect_reported("coated", MaterialType::kPrincipled, [](Material& m) {
    m.clearcoat = 1.0f;
    m.roughness = kNan;
  });
  expect_reported("a sheet", MaterialType::kPrincipled, [](Material& m) {
    m.transmission = 1.0f;
    m.thin = true;
    m.roughness = kNan;
  });
  expect_reported("plastic", MaterialType::kPrincipled, rough);
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

// The first ray meets what the sample sees, and the others what is in the scene.
void expect_what_was_met(const TracedSample& s, const Scene& scene) {
  const std::optional<SurfaceInteraction>& first = s.rays[0].met;
  ASSERT_EQ(first.has_value(), s.sample.depth < kFarDepth);
  if (first) {
    EXPECT_EQ(first->instance, s.sample.instance);
    EXPECT_EQ(first->p, s.sample.position);
  }
  for (const TracedRay& ray : s.rays) {
    if (!ray.met) continue;
    EXPECT_LT(ray.met->t, ray.ray.tfar);
    if (ray.query != RayLog::Query::kOccluded) continue;
    ASSERT_LT(ray.met->instance, scene.instances.size());
    EXPECT_TRUE(scene.instances[ray.met->instance].casts_shadow);
  }
}

// A pixel looked at closely is the pixel of the picture, by adaptive sampling and without.
TEST(TracePixel, ListsTheSamplesOfThePicture) {
  Scene scene = mixed_scene();
  scene.settings.spp = 32;
  for (const float target : {0.0f, 0.05f}) {
    scene.settings.noise_target = target;
    const RenderResult whole = render(scene, {});
    std::size_t fewest = 1000, most = 0;
    for (int y = 1; y < scene.settings.height; y += 7)
      for (int x = 2; x < scene.settings.width; x += 9) {
        const TracedPixel traced = trace_pixel(scene, x, y);
        expect_identical(traced.pixel, whole.film.at(x, y), x, y);
        const std::size_t n = traced.samples.size();
        ASSERT_EQ(n, traced.pixel.samples);
        fewest = std::min(fewest, n);
        most = std::max(most, n);
        // The mean of all halves, each of which is the mean of its samples.
        Imath::V3d sums[2] = {Imath::V3d(0.0), Imath::V3d(0.0)};
        std::uint32_t counts[2] = {0, 0};
        for (const TracedSample& s : traced.samples) {
          ASSERT_LT(s.half, 2u);
          EXPECT_EQ(s.index, counts[s.half]++);
          ASSERT_FALSE(s.rays.empty());
          expect_what_was_met(s, scene);
          sums[s.half] += Imath::V3d(s.sample.radiance);
        }
        const double halves = target > 0.0f ? 2.0 : 1.0;
        Imath::V3d mean(0.0);
        for (int h = 0; h < static_cast<int>(halves); ++h)
          mean += sums[h] / (halves * std::max(counts[h], 1u));
        EXPECT_LT((mean - Imath::V3d(traced.pixel.color)).length(), 1e-5 * (1.0 + mean.length()));
      }
    EXPECT_EQ(most, 32u);
    if (target > 0.0f) {
      EXPECT_LT(fewest, 32u);
    } else {
      EXPECT_EQ(fewest, 32u);
    }
  }
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

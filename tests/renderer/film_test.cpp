// SPDX-License-Identifier: Apache-2.0
#include "renderer/film/film_sums.h"
#include "renderer/film/pixel_filter.h"

#include <gtest/gtest.h>

#include "renderer/camera/camera.h"
#include "renderer/image/tone_map.h"
#include "tests/renderer/statistics.h"

namespace morsel::render {
namespace {

TEST(PixelAccumulator, MeanAndVarianceOfTheMean) {
  PixelAccumulator pixel;
  const float values[] = {1.0f, 2.0f, 4.0f, 9.0f};
  for (const float v : values) {
    PathSample s;
    s.radiance = V3f(v, 10.0f * v, 1.0f);
    s.alpha = v > 3.0f ? 1.0f : 0.0f;
    pixel.add(s, 0.5f, 0.5f, 0);
  }
  const Pixel p = pixel.result();
  EXPECT_EQ(p.samples, 4u);
  EXPECT_FLOAT_EQ(p.color.x, 4.0f);
  EXPECT_FLOAT_EQ(p.color.y, 40.0f);
  EXPECT_FLOAT_EQ(p.alpha, 0.5f);
  // Deviations 3, 2, 0, 5: sum of squares 38, over 3 for the samples and over 4 for the mean.
  EXPECT_FLOAT_EQ(p.variance.x, 38.0f / 12.0f);
  EXPECT_FLOAT_EQ(p.variance.y, 3800.0f / 12.0f);
  EXPECT_FLOAT_EQ(p.variance.z, 0.0f);
}

TEST(PixelAccumulator, DepthAndComponentAreThoseNearestToTheCentre) {
  PixelAccumulator pixel;
  PathSample s;
  s.depth = 1.0f;
  s.component = 3.0f;
  pixel.add(s, 0.9f, 0.9f, 0);
  s.depth = 2.0f;
  s.component = 5.0f;
  pixel.add(s, 0.45f, 0.5f, 1);
  s.depth = 7.0f;
  s.component = 0.0f;
  pixel.add(s, 0.1f, 0.5f, 2);
  EXPECT_EQ(pixel.result().depth, 2.0f);
  EXPECT_EQ(pixel.result().component, 5.0f);
}

TEST(PixelAccumulator, WithoutSamplesIsEmpty) {
  const Pixel p = PixelAccumulator().result();
  EXPECT_EQ(p.samples, 0u);
  EXPECT_EQ(p.color, V3f(0.0f));
  EXPECT_EQ(p.depth, kFarDepth);
}

TEST(Camera, LooksWhereItShould) {
  SceneCamera c;
  c.position = V3f(0, 0, 5);
  c.vertical_fov = 90.0f;
  const Camera camera(c, 200, 100);
  EXPECT_NEAR((camera.direction(100, 50) - V3f(0, 0, -1)).length(), 0.0f, 1e-6f);
  EXPECT_NEAR((camera.direction(100, 0) - normalize(V3f(0, 1, -1))).length(), 0.0f, 1e-6f);
  EXPECT_NEAR((camera.direction(200, 50) - normalize(V3f(2, 0, -1))).length(), 0.0f, 1e-6f);
  EXPECT_NEAR((camera.direction(0, 100) - normalize(V3f(-2, -1, -1))).length(), 0.0f, 1e-6f);
}

TEST(Camera, MatricesAgreeWithItsDirections) {
  SceneCamera c;
  c.position = V3f(3, -2, 5);
  c.look_at = V3f(-1, 1, 0.5f);
  c.up = V3f(0.1f, 1, 0.3f);
  const Camera camera(c, 160, 90);
  for (const V2f& image : {V2f(0, 0), V2f(160, 90), V2f(37, 71), V2f(80, 45)}) {
    const V3f p = camera.position() + camera.direction(image.x, image.y) * 7.0f;
    const V3f ndc = p * camera.world_to_ndc();  // divides by w
    EXPECT_NEAR(ndc.x, image.x / 80.0f - 1.0f, 1e-5f);
    EXPECT_NEAR(ndc.y, 1.0f - image.y / 45.0f, 1e-5f);
    const V3f local = p * camera.world_to_camera();
    EXPECT_NEAR(local.length(), 7.0f, 1e-5f);
    EXPECT_NEAR(-local.z, dot(p - camera.position(), camera.forward()), 1e-5f);
  }
}

TEST(Camera, SphericalSeesEveryDirection) {
  SceneCamera c;
  c.projection = Projection::kSpherical;
  const Camera camera(c, 200, 100);
  EXPECT_NEAR((camera.direction(100, 50) - V3f(0, 0, -1)).length(), 0.0f, 1e-5f);
  EXPECT_NEAR((camera.direction(150, 50) - V3f(1, 0, 0)).length(), 0.0f, 1e-5f);
  EXPECT_NEAR((camera.direction(70, 0) - V3f(0, 1, 0)).length(), 0.0f, 1e-5f);
  EXPECT_NEAR((camera.direction(0, 50) - V3f(0, 0, 1)).length(), 0.0f, 1e-5f);
}

TEST(Camera, LensRaysMeetInTheFocus) {
  SceneCamera c;
  c.position = V3f(1, 2, 5);
  c.aperture_radius = 0.3f;
  c.focus_distance = 4.0f;
  for (const Projection projection : {Projection::kPerspective, Projection::kOrthographic})
    for (const int blades : {0, 5}) {
      c.projection = projection;
      c.blades = blades;
      const Camera camera(c, 64, 48);
      const auto focus = [&](const V2f& lens) {
        const Ray ray = camera.ray(12.3f, 31.0f, lens, 0.0f);
        const float t = 4.0f / dot(ray.direction, camera.forward());
        EXPECT_LE((ray.origin - camera.ray(12.3f, 31.0f, V2f(0.5f), 0.0f).origin).length(), 0.61f);
        return ray.origin + ray.direction * t;
      };
      for (const V2f& lens : {V2f(0.1f, 0.9f), V2f(0.7f, 0.2f), V2f(0.99f, 0.5f)})
        EXPECT_NEAR((focus(lens) - focus(V2f(0.4f, 0.4f))).length(), 0.0f, 1e-5f);
    }
}

// The offsets' moments are those of the filters.
TEST(PixelFilters, HaveTheirShape) {
  const auto variance = [](PixelFilter filter) {
    const FilterSampler sampler(filter, 2.0f);
    double mean = 0.0, square_mean = 0.0;
    constexpr int kCount = 10000;
    for (int i = 0; i < kCount; ++i) {
      const double x = sampler.sample(V2f((static_cast<float>(i) + 0.5f) / kCount, 0.5f)).x;
      EXPECT_LE(std::abs(x), 2.0);
      mean += x / kCount;
      square_mean += x * x / kCount;
    }
    EXPECT_NEAR(mean, 0.0, 1e-3);
    return square_mean;
  };
  EXPECT_NEAR(variance(PixelFilter::kBox), 4.0 / 3.0, 1e-3);
  EXPECT_NEAR(variance(PixelFilter::kTriangle), 4.0 / 6.0, 3e-3);
  // A standard deviation of a third of the radius, a little less for the cut ends.
  EXPECT_NEAR(variance(PixelFilter::kGaussian), 4.0 / 9.0, 0.05);
  EXPECT_LT(variance(PixelFilter::kBlackmanHarris), variance(PixelFilter::kGaussian));
}

// Hashes of the reference implementation of MurmurHash3_x86_32 with seed 0.
TEST(Cryptomatte, HashesAsSpecified) {
  EXPECT_EQ(cryptomatte::murmur3(""), 0u);
  EXPECT_EQ(cryptomatte::murmur3("hello"), 0x248bfa47u);
  EXPECT_EQ(cryptomatte::murmur3("hello, world"), 0x149bbb7fu);
  EXPECT_EQ(cryptomatte::murmur3("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
  for (int i = 0; i < 20000; ++i)
    EXPECT_TRUE(std::isnormal(cryptomatte::as_float(cryptomatte::id_of(std::to_string(i)))));
  EXPECT_EQ(cryptomatte::manifest_of({{"a\"b", 0x12u}}), "{\"a\\\"b\":\"00000012\"}");
}

TEST(Cryptomatte, RanksByShare) {
  cryptomatte::Accumulator a;
  for (const std::uint32_t id : {5u, 7u, 7u, 0u, 7u, 9u, 9u, 1u}) a.add(id);
  const auto ranks = a.ranks(8);
  EXPECT_EQ(ranks[0].id, 7u);
  EXPECT_EQ(ranks[0].coverage, 3.0f / 8.0f);
  EXPECT_EQ(ranks[1].id, 9u);
  EXPECT_EQ(ranks[4].coverage, 0.0f);
}

TEST(Camera, UpAlongTheViewIsReplaced) {
  SceneCamera c;
  c.position = V3f(0, 5, 0);
  const Camera camera(c, 10, 10);
  EXPECT_TRUE(is_finite(camera.direction(3, 4)));
  EXPECT_NEAR((camera.direction(5, 5) - V3f(0, -1, 0)).length(), 0.0f, 1e-6f);
}

TEST(ToneMap, IsMonotonicContinuousAndBounded) {
  float last = -1.0f;
  for (float x = 0.0f; x < 100.0f; x = x * 1.01f + 1e-4f) {
    const float y = tone_map(V3f(x), 0.0f).x;
    EXPECT_GE(y, last - 1e-6f);
    if (last >= 0.0f) {
      EXPECT_LT(y - last, 0.02f);
    }
    EXPECT_LE(y, 1.0f);
    last = y;
  }
  EXPECT_GT(last, 0.999f);
  // 18 % grey stays where sRGB has it, one stop doubles it.
  EXPECT_NEAR(tone_map(V3f(0.18f), 0.0f).x, 0.4613f, 1e-3f);
  EXPECT_NEAR(tone_map(V3f(0.18f), 1.0f).x, tone_map(V3f(0.36f), 0.0f).x, 1e-6f);
  EXPECT_EQ(tone_map(V3f(-1.0f), 0.0f), V3f(0.0f));
}

TEST(ToneMap, BrightColoursKeepTheirHue) {
  const V3f c = tone_map(V3f(4.0f, 1.0f, 0.2f), 0.0f);
  EXPECT_GT(c.x, c.y);
  EXPECT_GT(c.y, c.z + 0.1f);
}

TEST(ExactSum, StepsAreThoseOfTheCompilersConversion) {
  testing::Random random;
  for (int i = 0; i < 100000; ++i) {
    const double x = std::ldexp(2.0 * random() - 1.0, static_cast<int>(140.0f * random()) - 78);
    ASSERT_TRUE(in_steps(x) == static_cast<Int128>(x * 0x1p64)) << x;
  }
  for (const double x : {0.0, -0.0, 1.0, -1.0, 0x1p-64, -0x1p-65, 0.99999999999999989, 0x1p61})
    EXPECT_TRUE(in_steps(x) == static_cast<Int128>(x * 0x1p64)) << x;
}

}  // namespace
}  // namespace morsel::render

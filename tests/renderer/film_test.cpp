// SPDX-License-Identifier: Apache-2.0
#include "renderer/film/film.h"

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
    pixel.add(s, 0.5f, 0.5f);
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
  pixel.add(s, 0.9f, 0.9f);
  s.depth = 2.0f;
  s.component = 5.0f;
  pixel.add(s, 0.45f, 0.5f);
  s.depth = 7.0f;
  s.component = 0.0f;
  pixel.add(s, 0.1f, 0.5f);
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
  PerspectiveCamera c;
  c.position = V3f(0, 0, 5);
  c.vertical_fov = 90.0f;
  const Camera camera(c, 200, 100);
  EXPECT_NEAR((camera.direction(100, 50) - V3f(0, 0, -1)).length(), 0.0f, 1e-6f);
  EXPECT_NEAR((camera.direction(100, 0) - normalize(V3f(0, 1, -1))).length(), 0.0f, 1e-6f);
  EXPECT_NEAR((camera.direction(200, 50) - normalize(V3f(2, 0, -1))).length(), 0.0f, 1e-6f);
  EXPECT_NEAR((camera.direction(0, 100) - normalize(V3f(-2, -1, -1))).length(), 0.0f, 1e-6f);
}

TEST(Camera, MatricesAgreeWithItsDirections) {
  PerspectiveCamera c;
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

TEST(Camera, UpAlongTheViewIsReplaced) {
  PerspectiveCamera c;
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

}  // namespace
}  // namespace morsel::render

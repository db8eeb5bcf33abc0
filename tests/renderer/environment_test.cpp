// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/environment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "renderer/math/atan2.h"
#include "renderer/math/sine_cosine.h"
#include "tests/renderer/statistics.h"

namespace morsel::render {
namespace {

using testing::Random;
using testing::sphere_integral;

// A dim gradient with a small sun and a black band.
EnvironmentImage sun_image(int width = 64, int height = 32) {
  EnvironmentImage image;
  image.width = width;
  image.height = height;
  image.texels.clear();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float grey = y > height / 2 && x < width / 3
                             ? 0.0f
                             : 0.2f + 0.5f * static_cast<float>(x) / static_cast<float>(width);
      image.texels.emplace_back(grey, 0.8f * grey, 0.5f * grey);
    }
  image.texels[static_cast<std::size_t>(9 * width + 20)] = V3f(200.0f, 180.0f, 120.0f);
  image.texels[static_cast<std::size_t>(width - 1)] = V3f(50.0f);  // at the pole and the seam
  return image;
}

class RotatedEnvironment : public ::testing::TestWithParam<float> {};

TEST_P(RotatedEnvironment, SamplesHaveTheirDensity) {
  const Environment environment(sun_image(), V3f(1.0f), GetParam());
  const auto result = testing::chi_squared(
      [&](Random& random) { return std::optional(environment.sample(random.pair()).wi); },
      [&](const V3f& wi) { return environment.pdf(wi); }, 100000, 40);
  EXPECT_GT(result.p_value, 1e-4);
  EXPECT_NEAR(result.pdf_integral, 1.0, 5e-3);
}

TEST_P(RotatedEnvironment, EstimatesTheIntegralOfItsRadiance) {
  const Environment environment(sun_image(), V3f(1.0f, 2.0f, 3.0f), GetParam());
  Random random;
  constexpr int kSamples = 200000;
  double sum = 0.0, sum2 = 0.0, largest = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const LightSample s = environment.sample(random.pair());
    ASSERT_GT(s.pdf, 0.0f);
    const double x = luminance(s.radiance) / s.pdf;
    sum += x;
    sum2 += x * x;
    largest = std::max(largest, x);
  }
  const double mean = sum / kSamples;
  const double error = std::sqrt((sum2 / kSamples - mean * mean) / kSamples);
  const double exact =
      sphere_integral([&](const V3f& w) { return luminance(environment.radiance(w)); });
  EXPECT_NEAR(mean, exact, 4.0 * error + 0.005 * exact);
  // The density follows the light: no direction is a firefly.
  EXPECT_LT(largest, 2.5 * exact);
}

TEST_P(RotatedEnvironment, RadianceAndDensityAtOnceAreThoseAskedForAlone) {
  Random random;
  for (const bool highlights : {false, true}) {
    const Environment several(sun_image(), V3f(1.0f, 2.0f, 3.0f), GetParam(), highlights);
    const Environment constant(EnvironmentImage{}, V3f(0.5f), GetParam(), highlights);
    for (const Environment* environment : {&several, &constant})
      for (int i = 0; i < 1000; ++i) {
        // The sun is small: half of the directions are to find it.
        const V3f wi = i % 2 ? several.sample(random.pair()).wi : constant.sample(random.pair()).wi;
        const Environment::Arriving both = environment->arriving(wi);
        EXPECT_EQ(both.radiance, environment->radiance(wi));
        EXPECT_EQ(both.pdf, environment->pdf(wi));
      }
  }
}

INSTANTIATE_TEST_SUITE_P(Degrees, RotatedEnvironment, ::testing::Values(0.0f, 37.0f, -170.0f));

TEST(Environment, LightHasDensityWhereverItShines) {
  const Environment environment(sun_image(), V3f(1.0f), 12.0f);
  Random random;
  for (int i = 0; i < 200000; ++i) {
    const V3f w = random.direction();
    if (max_component(environment.radiance(w)) > 0.0f) {
      ASSERT_GT(environment.pdf(w), 0.0f);
    }
  }
}

TEST(Environment, HighlightsAloneHaveTheirDensityToo) {
  const Environment all(sun_image(), V3f(1.0f), 12.0f);
  const Environment highlights(sun_image(), V3f(1.0f), 12.0f, true);
  const auto result = testing::chi_squared(
      [&](Random& random) { return std::optional(highlights.sample(random.pair()).wi); },
      [&](const V3f& wi) { return highlights.pdf(wi); }, 100000, 40);
  EXPECT_GT(result.p_value, 1e-4);
  EXPECT_NEAR(result.pdf_integral, 1.0, 5e-3);
  EXPECT_LT(highlights.sampled_luminance(), all.sampled_luminance());
  Random random;
  int dark = 0;
  for (int i = 0; i < 1000; ++i) {
    const V3f w = random.direction();
    EXPECT_EQ(all.radiance(w), highlights.radiance(w));
    dark += highlights.pdf(w) == 0.0f;
  }
  EXPECT_GT(dark, 500);
  // An even sky leaves nothing to sample.
  EXPECT_EQ(Environment(EnvironmentImage{}, V3f(3.0f), 0.0f, true).sampled_luminance(), 0.0f);
}

// Widths that fill no whole number of blocks, and fewer texels than a block has.
TEST(Environment, SamplesAreThoseOfItsDensityAtAnySize) {
  for (const auto& [width, height] : {std::pair(2, 1), {3, 2}, {5, 3}, {63, 40}}) {
    EnvironmentImage image;
    image.width = width;
    image.height = height;
    image.texels.clear();
    Random random;
    for (int i = 0; i < width * height; ++i)
      image.texels.emplace_back(random() * random(), i % 3 == 0 ? 0.0f : 1.0f, random());
    const Environment environment(image, V3f(2.0f, 1.0f, 0.5f), 25.0f);
    double sum = 0.0;
    constexpr int kSamples = 20000;
    for (int i = 0; i < kSamples; ++i) {
      const LightSample s = environment.sample(random.pair());
      ASSERT_GT(s.pdf, 0.0f);
      const Environment::Arriving arriving = environment.arriving(s.wi);
      ASSERT_NEAR(arriving.pdf / s.pdf, 1.0f, 0.01f) << width << " x " << height;
      ASSERT_NEAR((arriving.radiance - s.radiance).length(), 0.0f, 1e-3f);
      sum += luminance(s.radiance) / s.pdf / kSamples;
    }
    const double exact =
        sphere_integral([&](const V3f& w) { return luminance(environment.radiance(w)); });
    EXPECT_NEAR(sum, exact, 0.02 * exact) << width << " x " << height;
  }
}

// Numbers of an image of halves come back as they are, others to 2^-11.
TEST(EnvironmentTexels, KeepTheImage) {
  Random random;
  EnvironmentImage image;
  image.width = 13;
  image.height = 6;
  image.texels.clear();
  for (int i = 0; i < 13 * 6; ++i) {
    // 11 bits over many powers of two, a sun, black.
    const auto half = [&] {
      return std::ldexp(std::floor(1024.0f * (1.0f + random())),
                        static_cast<int>(9 * random()) - 14);
    };
    image.texels.emplace_back(i == 20 ? 65504.0f : half(), half(), i % 7 == 0 ? 0.0f : half());
  }
  for (const float factor : {1.0f, 1.234567f, 1e30f, 1e-30f}) {
    EnvironmentImage scaled = image;
    for (V3f& t : scaled.texels) t *= factor;
    const EnvironmentTexels texels(scaled);
    for (int row = 0; row <= 6; ++row)
      for (int column = 0; column < 13; ++column) {
        const auto at = [&](int x, int y) {
          return scaled.texels[static_cast<std::size_t>(std::clamp(y, 0, 5) * 13 + x % 13)];
        };
        const EnvironmentTexels::Corners corners = texels.corners(row, column);
        const V3f a = corners.texel(0), b = corners.texel(1), c = corners.texel(2),
                  d = corners.texel(3);
        const V3f weight(0.3f, 0.5f, 0.25f);
        const float less = 0.5f * dot(a, weight);
        const auto weighed = texels.weigh(row, column / 4, weight, less);
        const int k = column % 4;
        const auto expected_of = [&](const V3f& texel) {
          return std::max(0.0f, dot(texel, weight) - less);
        };
        EXPECT_EQ(expected_of(a), weighed.upper_left[k]);
        EXPECT_EQ(expected_of(b), weighed.upper_right[k]);
        EXPECT_EQ(expected_of(c), weighed.lower_left[k]);
        EXPECT_EQ(expected_of(d), weighed.lower_right[k]);
        const V3f found[] = {a, b, c, d};
        const V3f expected[] = {at(column, row - 1), at(column + 1, row - 1), at(column, row),
                                at(column + 1, row)};
        for (int i = 0; i < 4; ++i)
          for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(found[i][channel], expected[i][channel],
                        factor == 1.0f ? 0.0f : 0x1p-11f * expected[i][channel])
                << row << ", " << column << ", corner " << i;
      }
  }
}

TEST(FastAtan2, IsCloseToTheLibrarys) {
  Random random;
  for (int i = 0; i < 100000; ++i) {
    const float y = 2.0f * random() - 1.0f, x = (2.0f * random() - 1.0f) * (i % 2 ? 1.0f : 1e-4f);
    ASSERT_NEAR(fast_atan2(y, x), std::atan2(y, x), 5e-7f) << y << ", " << x;
  }
  for (const float y : {0.0f, 1.0f, -1.0f, -0.0f})
    for (const float x : {1.0f, -1.0f, 1e-30f})
      EXPECT_NEAR(fast_atan2(y, x), std::atan2(y, x), 5e-7f);
  EXPECT_EQ(fast_atan2(0.0f, 0.0f), 0.0f);
}

TEST(SineCosine, AreAsAccurateAsStated) {
  const auto check = [](float turns) {
    const double angle = 6.283185307179586 * static_cast<double>(turns);
    const SineCosine found = sine_cosine_of_turns(turns);
    ASSERT_NEAR(found.sine, std::sin(angle), 2e-7) << turns;
    ASSERT_NEAR(found.cosine, std::cos(angle), 2e-7) << turns;
  };
  Random random;
  for (int i = 0; i < 200000; ++i) check(2.0f * random() - 1.0f);
  for (int eighths = -8; eighths <= 8; ++eighths)
    for (const float off : {0.0f, 1e-7f, -1e-7f}) {
      const float turns = 0.125f * static_cast<float>(eighths) + off;
      if (std::abs(turns) <= 1.0f) check(turns);
    }
}

TEST(Environment, ConstantIsUniform) {
  const Environment environment(EnvironmentImage{}, V3f(2.0f), 0.0f);
  Random random;
  for (int i = 0; i < 1000; ++i) {
    const LightSample s = environment.sample(random.pair());
    EXPECT_NEAR(s.pdf, 0.25f * kInvPi, 1e-6f);
    EXPECT_NEAR(environment.pdf(random.direction()), 0.25f * kInvPi, 1e-6f);
    EXPECT_EQ(s.radiance, V3f(2.0f));
  }
  EXPECT_NEAR(environment.sampled_luminance(), 2.0f, 1e-5f);
}

TEST(Environment, ConventionOfDirections) {
  EnvironmentImage image;
  image.width = 8;
  image.height = 4;
  image.texels.assign(32, V3f(0.0f));
  for (int y = 0; y < 4; ++y) {
    image.texels[static_cast<std::size_t>(8 * y + 3)].x = 1.0f;  // about the image's middle
    image.texels[static_cast<std::size_t>(8 * y + 4)].x = 1.0f;
    image.texels[static_cast<std::size_t>(8 * y + 5)].y = 1.0f;  // about three quarters
    image.texels[static_cast<std::size_t>(8 * y + 6)].y = 1.0f;
  }
  for (int x = 0; x < 8; ++x) image.texels[static_cast<std::size_t>(x)].z = 1.0f;  // top row
  const Environment environment(image, V3f(1.0f), 0.0f);
  EXPECT_EQ(environment.radiance(V3f(0, 0, -1)), V3f(1, 0, 0));
  EXPECT_EQ(environment.radiance(V3f(1, 0, 0)), V3f(0, 1, 0));
  EXPECT_EQ(environment.radiance(normalize(V3f(0.01f, 1, 0))).z, 1.0f);
  EXPECT_EQ(environment.radiance(V3f(0, -1, 0)).z, 0.0f);
  // A quarter turn counter-clockwise, seen from above: what was ahead (-z) is on the left (-x).
  const Environment turned(image, V3f(1.0f), 90.0f);
  EXPECT_NEAR(turned.radiance(V3f(-1, 0, 0)).x, 1.0f, 1e-5f);
  EXPECT_NEAR(turned.radiance(V3f(0, 0, -1)).y, 1.0f, 1e-5f);
}

TEST(Environment, RefusesAnImageOfTheWrongSize) {
  EnvironmentImage image;
  image.width = 3;
  EXPECT_THROW(Environment(image, V3f(1.0f), 0.0f), std::invalid_argument);
}

TEST(EnvironmentImage, NamesAFileThatCannotBeRead) {
  try {
    EnvironmentImage::read("/nowhere/sky.exr");
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_NE(std::string(e.what()).find("/nowhere/sky.exr"), std::string::npos);
  }
}

}  // namespace
}  // namespace morsel::render

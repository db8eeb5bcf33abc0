// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/light_set.h"

#include <gtest/gtest.h>

#include "tests/renderer/statistics.h"

namespace morsel::render {
namespace {

using testing::Random;
using testing::sphere_integral;

struct RectangleCase {
  const char* name;
  RectangleLight light;
  V3f p;
};
void PrintTo(const RectangleCase& c, std::ostream* out) { *out << c.name; }

RectangleLight rectangle(const V3f& corner, const V3f& u, const V3f& v) {
  RectangleLight light;
  light.name = "light";
  light.corner = corner;
  light.edge_u = u;
  light.edge_v = v;
  return light;
}

class SampledRectangle : public ::testing::TestWithParam<RectangleCase> {
 protected:
  // Distance to the light along `wi`, if it hits the emitting side.
  std::optional<float> hit(const V3f& wi) const {
    const auto& [name, l, p] = GetParam();
    const V3f n = cross(l.edge_u, l.edge_v);
    const float cosine = dot(wi, n);
    if (cosine >= 0.0f) return std::nullopt;
    const float t = dot(l.corner - p, n) / cosine;
    const V3f q = p + wi * t - l.corner;
    const float a = dot(cross(q, l.edge_v), n) / dot(n, n);
    const float b = dot(cross(l.edge_u, q), n) / dot(n, n);
    if (t <= 0.0f || a < 0.0f || a > 1.0f || b < 0.0f || b > 1.0f) return std::nullopt;
    return t;
  }
};

TEST_P(SampledRectangle, SamplesHaveTheirDensity) {
  const Rectangle light(GetParam().light);
  const V3f p = GetParam().p;
  const auto result = testing::chi_squared(
      [&](Random& random) {
        const LightSample s = light.sample(p, random.pair());
        return s.pdf > 0.0f ? std::optional(s.wi) : std::nullopt;
      },
      [&](const V3f& wi) {
        const auto t = hit(wi);
        return t ? light.pdf(p, wi, *t) : 0.0f;
      },
      20000, 100);  // the light's edges cut through cells: few samples, fine quadrature
  EXPECT_GT(result.p_value, 1e-4);
  EXPECT_NEAR(result.pdf_integral, 1.0, 0.02);
}

TEST_P(SampledRectangle, SamplesLieOnTheLight) {
  const Rectangle light(GetParam().light);
  const V3f p = GetParam().p;
  const V3f n = light.normal();
  Random random;
  for (int i = 0; i < 5000; ++i) {
    const LightSample s = light.sample(p, random.pair());
    ASSERT_GT(s.pdf, 0.0f);
    EXPECT_NEAR(light.pdf(p, s.wi, s.distance) / s.pdf, 1.0f, 1e-3f);
    const V3f q = p + s.wi * s.distance - GetParam().light.corner;
    EXPECT_NEAR(dot(q, n), 0.0f, 1e-4f * s.distance);
    EXPECT_NEAR(dot(s.wi, s.wi), 1.0f, 1e-5f);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Rectangles, SampledRectangle,
    ::testing::Values(
        RectangleCase{"near", rectangle({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}), {0.1f, 0.2f, 0.1f}},
        RectangleCase{"beside", rectangle({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}), {3.0f, 0.0f, -2.0f}},
        RectangleCase{"touching", rectangle({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}), {0.3f, 0.95f, 0}},
        RectangleCase{"tilted", rectangle({0, 2, 0}, {1, 1, 0}, {-0.5f, 0.5f, 2}), {2, 0, 1}},
        RectangleCase{"skewed", rectangle({0, 2, 0}, {1, 0, 0}, {0.6f, 0, 1}), {0.5f, 0, 0.5f}}),
    [](const auto& p) { return std::string(p.param.name); });

TEST(Rectangle, FarAwayBecomesAreaSamplingOfTheSameDensity) {
  // Solid angle 1 / 400: below the threshold. On axis the density is distance^2 / area.
  const Rectangle light(rectangle({-0.5f, 40, -0.5f}, {1, 0, 0}, {0, 0, 1}));
  const LightSample s = light.sample(V3f(0.0f), V2f(0.5f));
  EXPECT_NEAR(s.pdf, 1600.0f, 1.0f);
}

TEST(Rectangle, IsDarkFromBehind) {
  const Rectangle light(rectangle({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}));  // faces -y
  EXPECT_EQ(light.normal(), V3f(0, -1, 0));
  EXPECT_EQ(light.sample(V3f(0, 2, 0), V2f(0.5f)).pdf, 0.0f);
  EXPECT_EQ(light.importance(V3f(0, 2, 0)), 0.0f);
  EXPECT_EQ(light.pdf(V3f(0, 2, 0), V3f(0, -1, 0), 1.0f), 0.0f);
  EXPECT_GT(light.importance(V3f(0, 0, 0)), 0.0f);
}

TEST(Rectangle, RefusesOneWithoutArea) {
  EXPECT_THROW(Rectangle(rectangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0})), std::invalid_argument);
  EXPECT_THROW(Rectangle(rectangle({0, NAN, 0}, {1, 0, 0}, {0, 0, 1})), std::invalid_argument);
}

// Choosing among lights: the mixture's density is what sample() reports, and integrates right.
TEST(LightSet, SumsAllLights) {
  Scene scene;
  scene.environment.emplace();
  scene.environment->radiance = V3f(0.5f);
  scene.rectangles.push_back(rectangle({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}));
  scene.rectangles.back().radiance = V3f(3.0f);
  scene.rectangles.push_back(rectangle({3, -1, -1}, {0, 0, 2}, {0, 2, 0}));  // faces -x
  scene.rectangles.back().radiance = V3f(7.0f);
  scene.rectangles.push_back(rectangle({-3, -1, -1}, {0, 0, 2}, {0, 2, 0}));  // faces away
  const LightSet lights(scene, true);
  const V3f p(0.2f, 0.1f, 0.3f);
  Random random;
  constexpr int kSamples = 100000;
  double sum = 0.0, solid_angles[3] = {0, 0, 0};
  for (int i = 0; i < kSamples; ++i) {
    const float choice = random();
    const LightSample s = lights.sample(LightGroup::kAll, p, choice, random.pair());
    ASSERT_GT(s.pdf, 0.0f);
    sum += s.radiance.x / s.pdf / kSamples;
    const int which = std::isinf(s.distance) ? 0 : s.radiance.x == 3.0f ? 1 : 2;
    const float pdf = which == 0
                          ? lights.infinite_pdf(LightGroup::kAll, 0, p, s.wi)
                          : lights.local_pdf(LightGroup::kAll, static_cast<std::size_t>(which - 1),
                                             p, s.wi, s.distance);
    EXPECT_NEAR(pdf / s.pdf, 1.0f, 1e-3f);
    if (which == 0) {
      const auto both = lights.infinite_arriving(LightGroup::kAll, 0, p, lights.towards(s.wi));
      EXPECT_EQ(both.pdf, pdf);
      EXPECT_EQ(both.radiance, lights.infinite_radiance(0, s.wi));
    }
    solid_angles[which] += 1.0 / s.pdf / kSamples;
  }
  EXPECT_NEAR(solid_angles[0], 4.0 * kPi, 0.1);
  EXPECT_NEAR(sum, 0.5 * solid_angles[0] + 3.0 * solid_angles[1] + 7.0 * solid_angles[2], 1e-3);
  // Solid angle of the first by quadrature.
  const double first = sphere_integral([&](const V3f& w) {
    if (w.y <= 0.0f) return 0.0;
    const V3f q = p + w * ((1.0f - p.y) / w.y);
    return std::abs(q.x) < 1.0f && std::abs(q.z) < 1.0f ? 1.0 : 0.0;
  });
  EXPECT_NEAR(solid_angles[1], first, 0.02 * first);
}

TEST(LightSet, WithoutLightsSamplesNothing) {
  const LightSet lights(Scene{}, true);
  EXPECT_TRUE(lights.empty());
  EXPECT_EQ(lights.sample(LightGroup::kAll, V3f(0.0f), 0.5f, V2f(0.5f)).pdf, 0.0f);
}

}  // namespace
}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
// Disks, spheres, points, distant lights, emissive triangles and the light tree.
#include <gtest/gtest.h>

#include "renderer/light/light_set.h"
#include "renderer/light/sky.h"
#include "tests/renderer/statistics.h"

namespace morsel::render {
namespace {

using testing::Random;

struct LightCase {
  std::string name;
  LocalLight light;
  V3f p;
};
void PrintTo(const LightCase& c, std::ostream* out) { *out << c.name; }

DiskLight disk() {
  DiskLight d;
  d.position = V3f(0.5f, 2.0f, -0.3f);
  d.normal = V3f(0.2f, -1.0f, 0.1f);
  d.radius = 1.2f;
  d.radiance = V3f(3.0f);
  return d;
}
SphereLight ball() {
  SphereLight s;
  s.position = V3f(0.5f, 2.0f, -0.3f);
  s.radius = 0.8f;
  s.radiance = V3f(3.0f);
  return s;
}
EmissiveTriangle triangle() {
  return {V3f(-1, 2, -1), V3f(1.5f, 2.2f, 0), V3f(0, 1.5f, 1.5f), V3f(3.0f)};
}

class LocalLights : public ::testing::TestWithParam<LightCase> {};

// Distance along `wi` to the light, by sampling only: what pdf() needs is checked against sample().
TEST_P(LocalLights, PdfIsWhatSampleReports) {
  const LightCase& c = GetParam();
  Random random;
  for (int i = 0; i < 2000; ++i) {
    const LightSample s =
        std::visit([&](const auto& l) { return l.sample(c.p, random.pair()); }, c.light);
    ASSERT_GT(s.pdf, 0.0f);
    const float pdf =
        std::visit([&](const auto& l) { return l.pdf(c.p, s.wi, s.distance); }, c.light);
    EXPECT_NEAR(pdf / s.pdf, 1.0f, 2e-3f);
    EXPECT_NEAR(dot(s.wi, s.wi), 1.0f, 1e-5f);
  }
}

// The mean of 1 / pdf is the solid angle; here by the share of uniform directions that hit.
TEST_P(LocalLights, SamplesHaveTheirDensity) {
  const LightCase& c = GetParam();
  const auto density = [&](const V3f& w) -> double {
    if (const auto* b = std::get_if<Ball>(&c.light)) {
      const SphereLight s = ball();
      const V3f d = s.position - c.p;
      const float along = dot(d, w);
      const bool hit = along > 0.0f && dot(d, d) - along * along < square(s.radius);
      return hit ? b->pdf(c.p, w, 1.0f) : 0.0;
    }
    if (const auto* k = std::get_if<Disk>(&c.light)) {
      const DiskLight s = disk();
      const V3f n = normalize(s.normal);
      const float t = dot(s.position - c.p, n) / dot(w, n);
      if (!(t > 0.0f)) return 0.0;
      const V3f q = c.p + w * t - s.position;
      return dot(q, q) < square(s.radius) ? k->pdf(c.p, w, t) : 0.0;
    }
    const V3f a(-1, 2, -1), e1 = V3f(1.5f, 2.2f, 0) - a, e2 = V3f(0, 1.5f, 1.5f) - a;
    const V3f h = cross(w, e2);
    const float det = dot(e1, h);
    const V3f s = c.p - a;
    const float u = dot(s, h) / det;
    const V3f q = cross(s, e1);
    const float v = dot(w, q) / det, t = dot(e2, q) / det;
    const bool hit = u > 0.0f && v > 0.0f && u + v < 1.0f && t > 0.0f;
    return hit ? std::get<EmissiveTriangle>(c.light).pdf(c.p, w, t) : 0.0;
  };
  const auto result = testing::chi_squared(
      [&](Random& random) {
        return std::optional(
            std::visit([&](const auto& l) { return l.sample(c.p, random.pair()).wi; }, c.light));
      },
      density, 30000, 60);
  EXPECT_GT(result.p_value, 1e-4);
  EXPECT_NEAR(result.pdf_integral, 1.0, 0.01);
}

INSTANTIATE_TEST_SUITE_P(
    All, LocalLights,
    ::testing::Values(LightCase{"disk_near", Disk(disk()), V3f(0.3f, 1.2f, 0)},
                      LightCase{"disk_far", Disk(disk()), V3f(1, -1, 0.5f)},
                      LightCase{"ball_near", Ball(ball()), V3f(0.4f, 1.1f, -0.2f)},
                      LightCase{"ball_far", Ball(ball()), V3f(1, -1, 0.5f)},
                      LightCase{"triangle_front", triangle(), V3f(0.2f, 0.5f, 0.1f)},
                      LightCase{"triangle_back", triangle(), V3f(0.2f, 3.2f, 0.1f)}),
    [](const auto& p) { return p.param.name; });

TEST(Ball, CastsNoLightInside) {
  EXPECT_EQ(Ball(ball()).sample(ball().position + V3f(0.1f), V2f(0.5f)).pdf, 0.0f);
}

TEST(Distant, ItsIrradianceDoesNotDependOnItsDiameter) {
  Random random;
  for (const float diameter : {0.01f, 0.53f, 10.0f}) {
    DistantLight d;
    d.direction = V3f(0, -1, 0);
    d.angular_diameter = diameter;
    d.irradiance = V3f(2.0f);
    const Distant light(d);
    double sum = 0.0;
    for (int i = 0; i < 20000; ++i) {
      const LightSample s = light.sample(random.pair());
      EXPECT_NEAR(light.pdf(s.wi) / s.pdf, 1.0f, 1e-3f);
      EXPECT_EQ(light.radiance(s.wi), s.radiance);
      sum += s.radiance.x * s.wi.y / s.pdf / 20000;
    }
    EXPECT_NEAR(sum, 2.0, 0.01) << diameter;
  }
  DistantLight sharp;
  sharp.angular_diameter = 0.0f;
  EXPECT_TRUE(Distant(sharp).sample(V2f(0.5f)).delta);
}

TEST(Point, ASpotFadesBetweenItsAngles) {
  PointLight p;
  p.position = V3f(0, 2, 0);
  p.direction = V3f(0, -1, 0);
  p.inner_angle = 10.0f;
  p.outer_angle = 30.0f;
  p.intensity = V3f(8.0f);
  const Point light(p);
  EXPECT_NEAR(light.sample(V3f(0, 0, 0), V2f(0.0f)).radiance.x, 2.0f, 1e-5f);
  EXPECT_EQ(light.importance(V3f(0, 3, 0)), 0.0f);
  EXPECT_EQ(light.importance(V3f(3, 0, 0)), 0.0f);
  const float between = light.sample(V3f(0.7f, 0, 0), V2f(0.0f)).radiance.x;
  EXPECT_GT(between, 0.0f);
  EXPECT_LT(between, 8.0f / 4.49f);
}

std::vector<LocalLight> many_lights(int count) {
  Random random;
  std::vector<LocalLight> lights;
  for (int i = 0; i < count; ++i) {
    const V3f a = random.direction() * (4.0f * random());
    lights.emplace_back(EmissiveTriangle(a, a + random.direction() * 0.3f,
                                         a + random.direction() * 0.3f, V3f(0.1f + random())));
    if (i % 5 == 0) {
      RectangleLight r;
      r.corner = a;
      r.edge_u = V3f(0.3f, 0, 0);
      r.edge_v = V3f(0, 0.2f, 0);
      lights.emplace_back(Rectangle(r));
    }
    if (i % 7 == 0) {
      SphereLight s;
      s.position = a;
      s.radius = 0.1f;
      lights.emplace_back(Ball(s));
    }
  }
  return lights;
}

TEST(LightTree, ProbabilitiesAreThoseOfSampling) {
  for (const int count : {1, 2, 3, 50}) {
    const auto lights = many_lights(count);
    std::vector<LightBounds> bounds;
    for (const auto& l : lights)
      bounds.push_back(std::visit([](const auto& x) { return x.bounds(); }, l));
    const LightTree tree(bounds);
    Random random(3);
    for (int k = 0; k < 20; ++k) {
      const V3f p = random.direction() * (5.0f * random());
      const auto importance = [&](std::uint32_t i) {
        return std::visit([&](const auto& l) { return l.importance(p); }, lights[i]);
      };
      double sum = 0.0;
      for (std::uint32_t i = 0; i < lights.size(); ++i) sum += tree.probability(p, i, importance);
      // A dead end (both halves dark although their node was not) may lose a little.
      EXPECT_LE(sum, 1.0001);
      if (count >= 50) {
        EXPECT_GT(sum, 0.95) << p;
      }
      for (int i = 0; i < 200; ++i) {
        const auto choice = tree.sample(p, random(), importance);
        if (choice.probability > 0.0f) {
          EXPECT_NEAR(tree.probability(p, choice.light, importance) / choice.probability, 1.0f,
                      1e-4f);
        }
      }
    }
  }
}

// A light that shines on a point is never out of reach of the choice.
TEST(LightTree, ReachesEveryLightThatShines) {
  const auto lights = many_lights(300);
  std::vector<LightBounds> bounds;
  for (const auto& l : lights)
    bounds.push_back(std::visit([](const auto& x) { return x.bounds(); }, l));
  const LightTree tree(bounds);
  Random random(5);
  for (int k = 0; k < 100; ++k) {
    const V3f p = random.direction() * (6.0f * random());
    const auto importance = [&](std::uint32_t i) {
      return std::visit([&](const auto& l) { return l.importance(p); }, lights[i]);
    };
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
      const bool shines = importance(i) > 0.0f;
      EXPECT_EQ(tree.probability(p, i, importance) > 0.0f, shines) << i << p;
    }
  }
}

// The tree's choice pays: against a uniform choice among a thousand lights.
TEST(LightTree, LowersTheVarianceOfManyLights) {
  const auto lights = many_lights(1000);
  std::vector<LightBounds> bounds;
  for (const auto& l : lights)
    bounds.push_back(std::visit([](const auto& x) { return x.bounds(); }, l));
  const LightTree tree(bounds);
  Random random(9);
  const V3f p(0.5f, 0.2f, -0.1f);
  const auto importance = [&](std::uint32_t i) {
    return std::visit([&](const auto& l) { return l.importance(p); }, lights[i]);
  };
  const auto contribution = [&](std::uint32_t i) {
    const LightSample s =
        std::visit([&](const auto& l) { return l.sample(p, random.pair()); }, lights[i]);
    return s.pdf > 0.0f ? double{s.radiance.x * std::max(0.0f, s.wi.y)} / s.pdf : 0.0;
  };
  double mean[2] = {}, squares[2] = {};
  constexpr int kSamples = 200000;
  for (int i = 0; i < kSamples; ++i) {
    const auto choice = tree.sample(p, random(), importance);
    const double a =
        choice.probability > 0.0f ? contribution(choice.light) / choice.probability : 0.0;
    const auto any = static_cast<std::uint32_t>(random() * static_cast<float>(lights.size()));
    const double b = contribution(any) * static_cast<double>(lights.size());
    mean[0] += a / kSamples, squares[0] += a * a / kSamples;
    mean[1] += b / kSamples, squares[1] += b * b / kSamples;
  }
  const double variance[2] = {squares[0] - mean[0] * mean[0], squares[1] - mean[1] * mean[1]};
  EXPECT_NEAR(mean[0], mean[1], 5.0 * std::sqrt((variance[0] + variance[1]) / kSamples));
  EXPECT_LT(variance[0], 0.1 * variance[1]);
}

TEST(Sky, IsBlueAboveAndTheSunIsWhereItIsSaidToBe) {
  SkyLight sky;
  sky.sun_elevation = 35.0f;
  sky.sun_azimuth = 90.0f;
  const Environment environment(sky_image(sky), V3f(1.0f), 0.0f);
  const V3f up = environment.radiance(V3f(0, 1, 0));
  EXPECT_GT(up.z, 1.3f * up.x);
  // Daylight in the unit of 10 kcd/m^2: the zenith has some thousand cd/m^2.
  EXPECT_GT(luminance(up), 0.1f);
  EXPECT_LT(luminance(up), 1.0f);
  const DistantLight sun = sun_of(sky);
  EXPECT_NEAR(-sun.direction.x, std::cos(35.0f * kPi / 180.0f), 1e-5f);
  EXPECT_NEAR(-sun.direction.y, std::sin(35.0f * kPi / 180.0f), 1e-5f);
  EXPECT_GT(sun.irradiance.x, sun.irradiance.z);  // the blue is scattered out
  EXPECT_GT(luminance(environment.radiance(normalize(V3f(1.0f, 0.9f, 0)))),
            luminance(environment.radiance(normalize(V3f(-1.0f, 0.9f, 0)))));
  sky.sun_elevation = -5.0f;
  EXPECT_EQ(sun_of(sky).irradiance, V3f(0.0f));
}

}  // namespace
}  // namespace morsel::render

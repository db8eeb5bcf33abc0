// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/bsdf.h"

#include <gtest/gtest.h>

#include <string>

#include "renderer/bsdf/fresnel.h"
#include "tests/renderer/statistics.h"

namespace morsel::render {
namespace {

using testing::Random;

struct Case {
  std::string name;
  Lobe lobe;
  float degrees;  // of incidence

  V3f wo() const {
    const float angle = degrees * kPi / 180.0f;
    return {std::sin(angle) * 0.8f, std::sin(angle) * 0.6f, std::cos(angle)};
  }
  LobeValue evaluate(const V3f& wi) const {
    return std::visit([&](const auto& l) { return l.evaluate(wo(), wi); }, lobe);
  }
  std::optional<LobeSample> sample(float choice, const V2f& u) const {
    return std::visit([&](const auto& l) { return l.sample(wo(), choice, u); }, lobe);
  }
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::vector<Case> rough_cases() {
  std::vector<Case> cases;
  for (const float degrees : {0.0f, 30.0f, 60.0f, 80.0f}) {
    const std::string at = "_at_" + std::to_string(static_cast<int>(degrees));
    cases.push_back({"diffuse" + at, Diffuse(V3f(0.2f, 0.5f, 0.9f)), degrees});
    for (const float roughness : {0.25f, 0.5f, 0.8f, 1.0f}) {
      const float alpha = roughness * roughness;
      const std::string r = "_rough_" + std::to_string(static_cast<int>(100 * roughness)) + at;
      cases.push_back({"conductor" + r, Conductor(V3f(0.9f, 0.6f, 0.3f), alpha), degrees});
      cases.push_back({"glass_outside" + r, Dielectric(V3f(1.0f), alpha, 1.5f), degrees});
      cases.push_back({"glass_inside" + r, Dielectric(V3f(1.0f), alpha, 1.0f / 1.5f), degrees});
    }
  }
  return cases;
}

class RoughLobe : public ::testing::TestWithParam<Case> {};

TEST_P(RoughLobe, SamplesHaveTheirDensity) {
  const Case& c = GetParam();
  const auto result = testing::chi_squared(
      [&](Random& random) -> std::optional<V3f> {
        const float choice = random();
        const auto s = c.sample(choice, random.pair());
        return s ? std::optional(s->wi) : std::nullopt;
      },
      [&](const V3f& wi) { return c.evaluate(wi).pdf; });
  EXPECT_GT(result.p_value, 1e-4);
  EXPECT_NEAR(result.pdf_integral, result.accepted, 0.01);
  EXPECT_LE(result.pdf_integral, 1.001);
  if (std::holds_alternative<Diffuse>(c.lobe)) {
    EXPECT_NEAR(result.pdf_integral, 1.0, 1e-3);
  }
}

TEST_P(RoughLobe, SampleAndEvaluateAgree) {
  const Case& c = GetParam();
  Random random;
  int checked = 0;
  for (int i = 0; i < 5000; ++i) {
    const float choice = random();
    const auto s = c.sample(choice, random.pair());
    // At grazing angles the half vector is not recovered to many digits.
    if (!s || std::abs(s->wi.z) < 0.02f) continue;
    const LobeValue v = c.evaluate(s->wi);
    EXPECT_NEAR(v.pdf / s->pdf, 1.0, 0.02);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(v.value[k] / v.pdf, s->weight[k], 0.01);
    EXPECT_EQ(s->transmission, s->wi.z < 0.0f);
    EXPECT_NEAR(dot(s->wi, s->wi), 1.0f, 1e-5f);
    ++checked;
  }
  EXPECT_GT(checked, 1000);
}

TEST_P(RoughLobe, NeverGivesMoreThanItGets) {
  const Case& c = GetParam();
  Random random;
  constexpr int kSamples = 20000;
  V3d energy(0.0);
  for (int i = 0; i < kSamples; ++i) {
    const float choice = random();
    if (const auto s = c.sample(choice, random.pair())) energy += s->weight * s->eta_squared;
  }
  energy /= kSamples;
  for (int k = 0; k < 3; ++k) EXPECT_LE(energy[k], 1.005);
}

INSTANTIATE_TEST_SUITE_P(All, RoughLobe, ::testing::ValuesIn(rough_cases()),
                         [](const auto& p) { return p.param.name; });

template <class L>
double white_furnace(const L& lobe, const V3f& wo) {
  Random random;
  constexpr int kSamples = 100000;
  double sum = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const float choice = random();
    if (const auto s = lobe.sample(wo, choice, random.pair())) sum += s->weight.x * s->eta_squared;
  }
  return sum / kSamples;
}

const V3f kDirections[] = {V3f(0, 0, 1), V3f(0.6f, 0, 0.8f), V3f(0, -0.8f, 0.6f),
                           V3f(0.96f, 0, 0.28f)};

TEST(WhiteFurnace, DiffuseReturnsEverything) {
  for (const V3f& wo : kDirections) EXPECT_NEAR(white_furnace(Diffuse(V3f(1.0f)), wo), 1.0, 1e-5);
}

TEST(WhiteFurnace, WhiteMetalReturnsEverythingAtAnyRoughness) {
  for (const V3f& wo : kDirections)
    for (const float alpha : {0.0f, 0.01f, 0.1f, 0.3f, 0.6f, 1.0f})
      EXPECT_NEAR(white_furnace(Conductor(V3f(1.0f), alpha), wo), 1.0, 0.01) << alpha << wo;
}

TEST(WhiteFurnace, RoughMetalLosesEnergyWithoutCompensation) {
  EXPECT_LT(white_furnace(Conductor(V3f(1.0f), 1.0f, false), V3f(0.6f, 0, 0.8f)), 0.8);
}

TEST(WhiteFurnace, ClearGlassReturnsEverythingAndRoughGlassAlmost) {
  for (const V3f& wo : kDirections)
    for (const float eta : {1.5f, 1.0f / 1.5f, 1.0f}) {
      EXPECT_NEAR(white_furnace(Dielectric(V3f(1.0f), 0.0f, eta), wo), 1.0, 1e-5);
      EXPECT_NEAR(white_furnace(Dielectric(V3f(1.0f), 0.02f, eta), wo), 1.0, 0.01);
    }
}

TEST(Reciprocity, DiffuseConductorAndGlass) {
  Random random;
  int checked = 0;
  for (int i = 0; i < 20000; ++i) {
    V3f a = random.direction(), b = random.direction();
    a.z = std::abs(a.z);
    if (a.z < 0.05f || std::abs(b.z) < 0.05f) continue;
    const float alpha = 0.05f + 0.9f * random();
    const V3f b_up(b.x, b.y, std::abs(b.z));
    const auto reflected = [&](const auto& lobe, const V3f& wo, const V3f& wi) {
      return lobe.evaluate(wo, wi).value.x / wi.z;
    };
    const Diffuse diffuse(V3f(0.7f));
    EXPECT_FLOAT_EQ(reflected(diffuse, a, b_up), reflected(diffuse, b_up, a));
    const Conductor metal(V3f(0.7f), alpha, false);
    const float m = reflected(metal, a, b_up);
    EXPECT_NEAR(reflected(metal, b_up, a), m, 1e-3f * m);
    const Dielectric glass(V3f(1.0f), alpha, 1.5f);
    const float g = reflected(glass, a, b_up);
    EXPECT_NEAR(reflected(glass, b_up, a), g, 1e-3f * g);

    // Refraction: f(wo, wi) / eta_o^2 is symmetric. From below, the frame and eta are turned round.
    const V3f below(b.x, b.y, -std::abs(b.z));
    const Dielectric from_inside(V3f(1.0f), alpha, 1.0f / 1.5f);
    const float there = glass.evaluate(a, below).value.x / -below.z;
    const float back =
        from_inside.evaluate(V3f(b.x, b.y, -below.z), V3f(a.x, a.y, -a.z)).value.x / a.z;
    // Next to total reflection 1 - F has lost its digits.
    EXPECT_NEAR(back, there * 1.5f * 1.5f, 2e-3f * back + 1e-5f);
    checked += there > 0.0f;
  }
  EXPECT_GT(checked, 1000);
}

TEST(Fresnel, KnownValues) {
  float cos_t = 0.0f;
  EXPECT_NEAR(fresnel_dielectric(1.0f, 1.5f, cos_t), 0.04f, 1e-6f);
  EXPECT_NEAR(cos_t, 1.0f, 1e-6f);
  EXPECT_NEAR(fresnel_dielectric(0.0f, 1.5f, cos_t), 1.0f, 1e-6f);
  EXPECT_EQ(fresnel_dielectric(0.5f, 1.0f / 1.5f, cos_t), 1.0f);  // total: sin = 0.87 > 1 / 1.5
  EXPECT_EQ(cos_t, 0.0f);
  // Brewster's angle: only the perpendicular part is reflected, ((eta^2 - 1) / (eta^2 + 1))^2 / 2.
  const float brewster = std::cos(std::atan(1.5f));
  EXPECT_NEAR(fresnel_dielectric(brewster, 1.5f, cos_t), 0.5f * square(1.25f / 3.25f), 1e-6f);
  EXPECT_EQ(fresnel_schlick(V3f(0.3f), 1.0f), V3f(0.3f));
  EXPECT_EQ(fresnel_schlick(V3f(0.3f), 0.0f), V3f(1.0f));
}

TEST(SmoothGlass, RefractsBySnell) {
  const Dielectric glass(V3f(1.0f), 0.0f, 1.5f);
  const auto s = glass.sample(V3f(0.6f, 0.0f, 0.8f), 0.99f, V2f(0.5f));
  ASSERT_TRUE(s && s->transmission && s->delta);
  EXPECT_NEAR(s->wi.x, -0.4f, 1e-6f);
  EXPECT_LT(s->wi.z, 0.0f);
  EXPECT_NEAR(s->weight.x, 1.0f / 2.25f, 1e-6f);
  EXPECT_EQ(glass.evaluate(V3f(0.6f, 0.0f, 0.8f), s->wi).pdf, 0.0f);
}

Material material(MaterialType type, float roughness = 0.0f) {
  Material m;
  m.type = type;
  m.color = V3f(1.0f);
  m.roughness = roughness;
  return m;
}

// However wrong the interpolated normal: nothing leaks through opaque surfaces, nobody is blinded.
TEST(Bsdf, WildShadingNormalsNeitherLeakNorGoBlack) {
  Random random;
  const V3f ng(0, 0, 1);
  for (const float roughness : {0.0f, 0.3f, 0.8f})
    for (const MaterialType type : {MaterialType::kDiffuse, MaterialType::kConductor}) {
      const Material m = material(type, roughness);
      for (int i = 0; i < 3000; ++i) {
        V3f ns = random.direction(), wo = random.direction();
        if (ns.z < 0.01f) continue;
        if (std::abs(wo.z) < 0.01f) continue;
        const Bsdf bsdf(m, V3f(0.0f), ng, ns, wo);
        int reflected = 0;
        for (int k = 0; k < 32; ++k) {
          const float choice = random();
          const auto s = bsdf.sample(choice, random.pair());
          if (!s) continue;
          EXPECT_GT(s->wi.z * wo.z, 0.0f);
          EXPECT_TRUE(is_finite(s->weight));
          if (!s->delta) {
            EXPECT_LE(s->weight.x, 2.0f);  // compensated metal: up to 1 / E
          }
          ++reflected;
        }
        EXPECT_GT(reflected, 0) << roughness << ns << wo;
        const V3f wi = random.direction();
        if (wi.z * wo.z < 0.0f) {
          EXPECT_EQ(bsdf.evaluate(wi).value, V3f(0.0f));
        }
      }
    }
}

TEST(Bsdf, SamplesOfSmoothedSurfacesAgreeWithEvaluate) {
  Random random;
  const V3f ng(0, 0, 1), ns = normalize(V3f(0.4f, 0.1f, 1.0f)), wo = normalize(V3f(1, 1, 0.4f));
  for (const MaterialType type :
       {MaterialType::kDiffuse, MaterialType::kConductor, MaterialType::kDielectric}) {
    const Bsdf bsdf(material(type, 0.6f), V3f(0.0f), ng, ns, wo);
    for (int i = 0; i < 2000; ++i) {
      const float choice = random();
      const auto s = bsdf.sample(choice, random.pair());
      if (!s || std::abs(dot(s->wi, ns)) < 0.05f) continue;
      const LobeValue v = bsdf.evaluate(s->wi);
      EXPECT_NEAR(v.pdf / s->pdf, 1.0f, 0.01f);
      EXPECT_NEAR(v.value.x / v.pdf, s->weight.x, 0.01f * std::max(1.0f, s->weight.x));
    }
  }
}

TEST(Bsdf, CheckerboardInWorldXZ) {
  Material m = material(MaterialType::kDiffuse);
  m.color = V3f(0.1f);
  m.checker_color = V3f(0.9f);
  m.checker_size = 2.0f;
  const auto albedo = [&](const V3f& p) {
    return Bsdf(m, p, V3f(0, 1, 0), V3f(0, 1, 0), V3f(0, 1, 0)).albedo().x;
  };
  EXPECT_EQ(albedo(V3f(1, 0, 1)), 0.1f);
  EXPECT_EQ(albedo(V3f(3, 5, 1)), 0.9f);
  EXPECT_EQ(albedo(V3f(-1, 0, 1)), 0.9f);
  EXPECT_EQ(albedo(V3f(-1, 0, -1)), 0.1f);
}

}  // namespace
}  // namespace morsel::render

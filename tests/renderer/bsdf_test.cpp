// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/bsdf.h"

#include <gtest/gtest.h>

#include <string>

#include "renderer/bsdf/fresnel.h"
#include "renderer/material/material_set.h"
#include "renderer/sampler/sampler.h"
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

Dielectric glass(float alpha, float ior, bool outside, bool compensated = true) {
  return Dielectric(V3f(1.0f), alpha, ior, outside, compensated ? &interface_albedo(ior) : nullptr);
}

Plastic plastic(const V3f& color, float roughness, float diffuse_roughness = 0.0f) {
  return Plastic(Diffuse(color, diffuse_roughness), 1.0f, V3f(1.0f), square(roughness),
                 interface_albedo(1.5f));
}

SurfaceParameters principled(const V3f& color, float roughness) {
  SurfaceParameters p;
  p.type = MaterialType::kPrincipled;
  p.color = color;
  p.alpha = square(roughness);
  p.tables = &interface_albedo(p.ior);
  p.coat_tables = &interface_albedo(1.5f);
  return p;
}

// The principled material's parts and mixtures, by name.
std::vector<std::pair<std::string, SurfaceParameters>> principled_materials(const V3f& color,
                                                                            float roughness) {
  std::vector<std::pair<std::string, SurfaceParameters>> list;
  const auto add = [&](const char* name, const auto& set) {
    SurfaceParameters p = principled(color, roughness);
    set(p);
    list.emplace_back(name, p);
  };
  add("coat", [](auto& p) { p.clearcoat = 1.0f, p.clearcoat_alpha = 0.04f; });
  add("coated_metal",
      [](auto& p) { p.clearcoat = 0.7f, p.clearcoat_alpha = 0.1f, p.metallic = 1.0f; });
  add("sheen", [](auto& p) { p.sheen_color = V3f(0.8f, 0.4f, 0.2f), p.sheen_alpha = 0.25f; });
  add("half_metal", [](auto& p) { p.metallic = 0.5f, p.specular_color = V3f(1.0f, 0.5f, 0.2f); });
  add("half_glass", [](auto& p) { p.transmission = 0.5f; });
  add("everything", [](auto& p) {
    p.metallic = 0.3f, p.transmission = 0.4f, p.clearcoat = 0.5f, p.clearcoat_alpha = 0.2f;
    p.sheen_color = V3f(0.3f), p.sheen_alpha = 0.4f, p.diffuse_roughness = 0.6f;
  });
  add("thin", [](auto& p) { p.transmission = 0.6f, p.thin = true; });
  return list;
}

std::vector<Case> rough_cases() {
  std::vector<Case> cases;
  const V3f color(0.9f, 0.6f, 0.3f);
  for (const float degrees : {0.0f, 30.0f, 60.0f, 80.0f}) {
    const std::string at = "_at_" + std::to_string(static_cast<int>(degrees));
    cases.push_back({"diffuse" + at, Diffuse(V3f(0.2f, 0.5f, 0.9f)), degrees});
    cases.push_back({"clay" + at, Diffuse(V3f(0.2f, 0.5f, 0.9f), 0.8f), degrees});
    for (const float roughness : {0.25f, 0.5f, 0.8f, 1.0f}) {
      const float alpha = roughness * roughness;
      const std::string r = "_rough_" + std::to_string(static_cast<int>(100 * roughness)) + at;
      cases.push_back({"conductor" + r, Conductor(color, alpha), degrees});
      cases.push_back({"glass_outside" + r, glass(alpha, 1.5f, true), degrees});
      cases.push_back({"glass_inside" + r, glass(alpha, 1.5f, false), degrees});
      cases.push_back({"thin" + r, ThinGlass(color, alpha, 1.5f), degrees});
      cases.push_back({"plastic" + r, plastic(color, roughness, 0.3f), degrees});
    }
    for (const float roughness : {0.4f})
      for (const auto& [name, p] : principled_materials(color, roughness)) {
        const std::string r = "_rough_" + std::to_string(static_cast<int>(100 * roughness)) + at;
        cases.push_back({name + r, make_lobe(p, true), degrees});
        if (p.transmission > 0.0f)
          cases.push_back({name + "_inside" + r, make_lobe(p, false), degrees});
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
  V3d energy(0.0), squares(0.0);
  for (int i = 0; i < kSamples; ++i) {
    const float choice = random();
    if (const auto s = c.sample(choice, random.pair())) {
      const V3d weight(s->weight * s->eta_squared);
      energy += weight;
      squares += weight * weight;
    }
  }
  energy /= kSamples;
  squares /= kSamples;
  for (int k = 0; k < 3; ++k) {
    const double error = std::sqrt(std::max(0.0, squares[k] - energy[k] * energy[k]) / kSamples);
    EXPECT_LE(energy[k], 1.003 + 4.0 * error);
  }
}

INSTANTIATE_TEST_SUITE_P(All, RoughLobe, ::testing::ValuesIn(rough_cases()),
                         [](const auto& p) { return p.param.name; });

template <class L>
double white_furnace(const L& lobe, const V3f& wo) {
  PixelSampler sampler(0, 0, 1);  // far less noise than independent numbers
  constexpr std::uint32_t kSamples = 1u << 15;
  double sum = 0.0;
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    sampler.start_sample(i);
    if (const auto s = lobe.sample(wo, sampler.get_1d(0), sampler.get_2d(1)))
      sum += s->weight.x * s->eta_squared;
  }
  return sum / kSamples;
}

const V3f kDirections[] = {V3f(0, 0, 1), V3f(0.6f, 0, 0.8f), V3f(0, -0.8f, 0.6f),
                           V3f(0.96f, 0, 0.28f)};

TEST(WhiteFurnace, DiffuseReturnsEverything) {
  for (const V3f& wo : kDirections) EXPECT_NEAR(white_furnace(Diffuse(V3f(1.0f)), wo), 1.0, 1e-5);
}

// The share of white light that comes back (and passes) where nothing is absorbed.
void expect_white(const Lobe& lobe, const std::string& what) {
  for (const V3f& wo : kDirections) {
    const double e = std::visit([&](const auto& l) { return white_furnace(l, wo); }, lobe);
    EXPECT_GE(e, 0.98) << what << " seen along " << wo;
    EXPECT_LE(e, 1.005) << what << " seen along " << wo;
  }
}

const float kRoughnesses[] = {0.0f, 0.05f, 0.1f, 0.2f, 0.35f, 0.5f, 0.7f, 0.85f, 1.0f};

TEST(WhiteFurnace, EveryLobeReturnsEverythingAtAnyRoughness) {
  for (const float r : kRoughnesses) {
    const std::string at = " of roughness " + std::to_string(r);
    const float alpha = r * r;
    expect_white(Diffuse(V3f(1.0f), r), "diffuse" + at);
    expect_white(Conductor(V3f(1.0f), alpha), "metal" + at);
    expect_white(ThinGlass(V3f(1.0f), alpha, 1.5f), "thin glass" + at);
    for (const float ior : {1.0f, 1.1f, 1.33f, 1.5f, 2.4f})
      for (const bool outside : {true, false})
        expect_white(glass(alpha, ior, outside), "glass of index " + std::to_string(ior) + at);
    for (const float body : {0.0f, 0.5f, 1.0f})
      expect_white(plastic(V3f(1.0f), r, body), "plastic" + at);
  }
}

TEST(WhiteFurnace, EveryMixtureOfThePrincipledMaterialReturnsEverything) {
  for (const float r : kRoughnesses)
    for (auto [name, p] : principled_materials(V3f(1.0f), r)) {
      p.specular_color = V3f(1.0f);
      p.sheen_color = V3f(max_component(p.sheen_color));
      const std::string what = name + " of roughness " + std::to_string(r);
      expect_white(make_lobe(p, true), what);
      if (p.transmission > 0.0f) expect_white(make_lobe(p, false), what + " from inside");
    }
}

TEST(WhiteFurnace, RoughSurfacesLoseEnergyWithoutCompensation) {
  EXPECT_LT(white_furnace(Conductor(V3f(1.0f), 1.0f, false), V3f(0.6f, 0, 0.8f)), 0.8);
  EXPECT_LT(white_furnace(glass(1.0f, 1.5f, true, false), V3f(0.6f, 0, 0.8f)), 0.95);
}

// What the probabilities and layers go by must be what the lobes do.
TEST(Albedos, TablesAgreeWithSampling) {
  for (const float r : {0.1f, 0.4f, 0.8f})
    for (const V3f& wo : kDirections) {
      const SpecularLayer gloss(0.8f, V3f(0.5f), r * r, interface_albedo(1.5f));
      EXPECT_NEAR(gloss.directional_albedo(wo.z), white_furnace(gloss, wo), 0.004) << r << wo;
      const Sheen sheen(V3f(1.0f), r * r);
      EXPECT_NEAR(sheen_albedo()(wo.z, r * r), white_furnace(sheen, wo), 0.01) << r << wo;
    }
}

TEST(Reciprocity, EveryLobeWithoutLayers) {
  Random random;
  int checked = 0;
  for (int i = 0; i < 20000; ++i) {
    V3f a = random.direction(), b = random.direction();
    a.z = std::abs(a.z);
    if (a.z < 0.05f || std::abs(b.z) < 0.05f) continue;
    const float alpha = 0.05f + 0.9f * random();
    const V3f b_up(b.x, b.y, std::abs(b.z)), b_down(b.x, b.y, -std::abs(b.z));
    const auto f = [&](const auto& lobe, const V3f& wo, const V3f& wi) {
      return lobe.evaluate(wo, wi).value.x / std::abs(wi.z);
    };
    const auto expect_reciprocal = [&](const auto& lobe, float tolerance) {
      const float there = f(lobe, a, b_up);
      EXPECT_NEAR(f(lobe, b_up, a), there, tolerance * there);
    };
    expect_reciprocal(Diffuse(V3f(0.7f)), 1e-6f);
    expect_reciprocal(Diffuse(V3f(0.7f), alpha), 1e-4f);
    expect_reciprocal(Conductor(V3f(0.7f), alpha), 1e-3f);
    expect_reciprocal(Sheen(V3f(0.7f), alpha), 1e-3f);
    expect_reciprocal(plastic(V3f(0.7f), std::sqrt(alpha), 0.0f), 1e-3f);
    expect_reciprocal(glass(alpha, 1.5f, true), 1e-3f);
    const ThinGlass sheet(V3f(0.7f), alpha, 1.5f);
    expect_reciprocal(sheet, 1e-3f);
    const float through = f(sheet, a, b_down);
    EXPECT_NEAR(f(sheet, V3f(b.x, b.y, -b_down.z), V3f(a.x, a.y, -a.z)), through, 1e-3f * through);
    SurfaceParameters p = principled(V3f(0.7f), std::sqrt(alpha));
    p.metallic = 0.4f;
    p.transmission = 0.3f;
    expect_reciprocal(Principled(p, true), 2e-3f);

    // Refraction: f(wo, wi) / eta_o^2 is symmetric. From below, the frame and eta are turned round.
    const float there = f(glass(alpha, 1.5f, true), a, b_down);
    const float back = f(glass(alpha, 1.5f, false), V3f(b.x, b.y, -b_down.z), V3f(a.x, a.y, -a.z));
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
  const Dielectric glass(V3f(1.0f), 0.0f, 1.5f, true);
  const auto s = glass.sample(V3f(0.6f, 0.0f, 0.8f), 0.99f, V2f(0.5f));
  ASSERT_TRUE(s && s->transmission && s->delta);
  EXPECT_NEAR(s->wi.x, -0.4f, 1e-6f);
  EXPECT_LT(s->wi.z, 0.0f);
  EXPECT_NEAR(s->weight.x, 1.0f / 2.25f, 1e-6f);
  EXPECT_EQ(glass.evaluate(V3f(0.6f, 0.0f, 0.8f), s->wi).pdf, 0.0f);
}

SurfaceParameters material(MaterialType type, float roughness = 0.0f) {
  SurfaceParameters p = principled(V3f(1.0f), roughness);
  p.type = type;
  return p;
}

// However wrong the interpolated normal: nothing leaks through opaque surfaces, nobody is blinded.
TEST(Bsdf, WildShadingNormalsNeitherLeakNorGoBlack) {
  Random random;
  const V3f ng(0, 0, 1);
  for (const float roughness : {0.0f, 0.3f, 0.8f})
    for (const MaterialType type :
         {MaterialType::kDiffuse, MaterialType::kConductor, MaterialType::kPrincipled}) {
      const SurfaceParameters m = material(type, roughness);
      for (int i = 0; i < 3000; ++i) {
        V3f ns = random.direction(), wo = random.direction();
        if (ns.z < 0.01f) continue;
        if (std::abs(wo.z) < 0.01f) continue;
        const Bsdf bsdf(m, ng, ns, wo);
        int reflected = 0;
        for (int k = 0; k < 32; ++k) {
          const float choice = random();
          const auto s = bsdf.sample(choice, random.pair());
          if (!s) continue;
          EXPECT_GT(s->wi.z * wo.z, 0.0f);
          EXPECT_TRUE(is_finite(s->weight));
          if (!s->delta) {
            // Up to 1 / E, E being the share that a single bounce reflects.
            EXPECT_LE(s->weight.x, 5.0f);
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
  for (const MaterialType type : {MaterialType::kDiffuse, MaterialType::kConductor,
                                  MaterialType::kDielectric, MaterialType::kPrincipled}) {
    const Bsdf bsdf(material(type, 0.6f), ng, ns, wo);
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

TEST(MaterialSet, CheckerboardInWorldXZ) {
  Scene scene;
  scene.materials.emplace_back();
  Material& m = scene.materials.back();
  m.color = V3f(0.1f);
  m.checker_color = V3f(0.9f);
  m.checker_size = 2.0f;
  const MaterialSet materials(scene);
  const auto albedo = [&](const V3f& p) {
    SurfaceInteraction hit;
    hit.p = p;
    return materials.shade(hit, V3f(0, 1, 0)).parameters.color.x;
  };
  EXPECT_EQ(albedo(V3f(1, 0, 1)), 0.1f);
  EXPECT_EQ(albedo(V3f(3, 5, 1)), 0.9f);
  EXPECT_EQ(albedo(V3f(-1, 0, 1)), 0.9f);
  EXPECT_EQ(albedo(V3f(-1, 0, -1)), 0.1f);
}

}  // namespace
}  // namespace morsel::render

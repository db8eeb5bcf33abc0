// SPDX-License-Identifier: Apache-2.0
// Pictures do not depend on the vector instructions that the machine has: every set that Highway
// can use here, one at a time, from the labels to the pixels.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <optional>
#include <vector>

#include "hypertexture_geom/embree/geometry.h"
#include "renderer/integrator/render.h"
#include "tests/renderer/test_scenes.h"

namespace morsel::render {
namespace {

using namespace testing;

constexpr int kWidth = 40, kHeight = 30;

// Rounding may differ: a component of a pixel by this share of it. A path that meets an edge can go
// another way for it, so that so many pixels may be another sample's.
constexpr float kTolerance = 1e-3f;
constexpr int kMostOthers = kWidth * kHeight / 100;

std::shared_ptr<const geom::HypertextureGeometry> shape_of(const char* noise) {
  const nlohmann::json json{
      {"type", "hypertexture"},
      {"name", "rock"},
      {"keep", "all"},
      {"field",
       {{"density", {{"type", "sphere"}, {"radius", 0.8}}},
        {"modulations",
         {{{"type", "fbm"}, {"noise", noise}, {"amplitude", 0.5}, {"frequency", 2.5}}}}}}};
  const geom::Hypertexture h = geom::hypertexture_from_json(json, {"rock", ""});
  geom::GeometryOptions options;
  options.keep = h.keep;
  return std::make_shared<const geom::HypertextureGeometry>(
      h.field, std::make_shared<const topology::TopologyCache>(geom::build_cache(h)), options);
}

// Rough and clear, with a floor that gets its shadow: every kind of ray.
Film picture_of(const char* noise) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.7f));
  add_material(scene, MaterialType::kPrincipled, V3f(0.5f), 0.4f);
  scene.geometries.push_back({"rock", shape_of(noise)});
  Instance instance;
  instance.name = "rock";
  instance.material = 1;
  scene.instances.push_back(instance);
  add_mesh(scene, plane_mesh(4.0f, -1.2f), 0);
  add_constant_environment(scene, 0.5f);
  add_rectangle(scene, V3f(-1, 4, 1), V3f(2, 0, 0), V3f(0, 0, 2), 10.0f);
  scene.camera.position = V3f(0, 1, 5);
  scene.camera.vertical_fov = 40.0f;
  set_image(scene, kWidth, kHeight, 8, 4);
  return render(scene).film;
}

bool is_near(float a, float b) {
  return std::abs(a - b) <= kTolerance * (0.01f + std::max(std::abs(a), std::abs(b)));
}
bool is_near(const V3f& a, const V3f& b) {
  return is_near(a.x, b.x) && is_near(a.y, b.y) && is_near(a.z, b.z);
}

void compare(const Film& now, const Film& first) {
  int others = 0;
  double light = 0.0, first_light = 0.0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Pixel &a = now.at(x, y), &b = first.at(x, y);
      const bool same = is_near(a.color, b.color) && is_near(a.alpha, b.alpha) &&
                        is_near(a.albedo, b.albedo) && is_near(a.normal, b.normal) &&
                        is_near(a.depth, b.depth) && a.component == b.component;
      others += same ? 0 : 1;
      light += luminance(a.color);
      first_light += luminance(b.color);
    }
  EXPECT_LE(others, kMostOthers);
  EXPECT_NEAR(light, first_light, 1e-3 * first_light);
  ::testing::Test::RecordProperty("others", others);
  std::printf("%d of %d pixels differ by more than %g, the light by %.2g\n", others,
              kWidth * kHeight, double{kTolerance}, std::abs(light / first_light - 1.0));
}

class Pictures : public ::testing::TestWithParam<const char*> {
 protected:
  ~Pictures() override { use(0); }
  static void use(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

TEST_P(Pictures, DoNotDependOnInstructions) {
  std::vector<std::int64_t> targets;
  for (std::int64_t all = hwy::SupportedTargets(); all != 0; all &= all - 1)
    targets.push_back(all & -all);
  ASSERT_FALSE(targets.empty());
  std::optional<Film> first;
  for (const std::int64_t target : targets) {
    SCOPED_TRACE(hwy::TargetName(target));
    use(target);
    const Film now = picture_of(GetParam());
    if (first) compare(now, *first);
    if (!first) first = now;
  }
}

INSTANTIATE_TEST_SUITE_P(OfNoise, Pictures, ::testing::Values("sparse_convolution", "perlin"),
                         [](const auto& p) { return std::string(p.param); });

}  // namespace
}  // namespace morsel::render

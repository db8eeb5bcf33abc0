// SPDX-License-Identifier: Apache-2.0
// A closed box of coloured matte walls with a lamp at the ceiling against the radiosity equation,
// solved by finite elements: light of every colour after any number of bounces.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "renderer/integrator/render.h"
#include "tests/renderer/test_scenes.h"

namespace morsel::render {
namespace {

using namespace testing;

constexpr int kPatches = 16;  // along a wall's side
constexpr float kLamp = 0.5f, kRadiance = 6.0f;

// A wall of the box [-1, 1]^3, seen from inside.
struct Wall {
  const char* name;
  V3f normal, right;
  V3f albedo;
  V3f up() const { return cross(normal, right); }
  // `a`, `b` in [-1, 1].
  V3f at(float a, float b) const { return right * a + up() * b - normal; }
};
const V3f kWhite(0.725f, 0.71f, 0.68f);
const std::array<Wall, 6> kWalls{{{"left", V3f(1, 0, 0), V3f(0, 0, -1), V3f(0.63f, 0.065f, 0.05f)},
                                  {"right", V3f(-1, 0, 0), V3f(0, 0, 1), V3f(0.14f, 0.45f, 0.091f)},
                                  {"back", V3f(0, 0, 1), V3f(1, 0, 0), V3f(0.1f, 0.2f, 0.7f)},
                                  {"front", V3f(0, 0, -1), V3f(-1, 0, 0), kWhite},
                                  {"floor", V3f(0, 1, 0), V3f(1, 0, 0), kWhite},
                                  {"ceiling", V3f(0, -1, 0), V3f(1, 0, 0), kWhite}}};

struct Patch {
  V3f centre, normal, corner[4], albedo{0.0f}, emitted{0.0f}, radiosity{0.0f};
};

// The share of a small matte surface's light that a polygon gets: Lambert's sum over its edges.
double form_factor(const Patch& from, const Patch& to) {
  V3d d[4];
  for (int k = 0; k < 4; ++k) d[k] = V3d(to.corner[k] - from.centre).normalized();
  double sum = 0.0;
  for (int k = 0; k < 4; ++k) {
    const V3d &a = d[k], &b = d[(k + 1) % 4];
    const V3d normal = a.cross(b);
    const double length = normal.length();
    if (length > 0.0) sum += std::atan2(length, a.dot(b)) * normal.dot(V3d(from.normal)) / length;
  }
  return std::abs(sum) / (2.0 * 3.14159265358979323846);
}

std::vector<Patch> patches_of_box() {
  std::vector<Patch> patches;
  for (const Wall& wall : kWalls)
    for (int j = 0; j < kPatches; ++j)
      for (int i = 0; i < kPatches; ++i) {
        const auto edge = [](int k) { return 2.0f * static_cast<float>(k) / kPatches - 1.0f; };
        const float a = edge(i), b = edge(j), side = 2.0f / kPatches;
        Patch p;
        p.centre = wall.at(a + 0.5f * side, b + 0.5f * side);
        p.normal = wall.normal;
        p.corner[0] = wall.at(a, b);
        p.corner[1] = wall.at(a + side, b);
        p.corner[2] = wall.at(a + side, b + side);
        p.corner[3] = wall.at(a, b + side);
        const bool lamp = wall.normal.y < 0.0f && std::abs(a + 0.5f * side) < kLamp &&
                          std::abs(b + 0.5f * side) < kLamp;
        if (lamp)
          p.emitted = V3f(kPi * kRadiance);
        else
          p.albedo = wall.albedo;
        p.radiosity = p.emitted;
        patches.push_back(p);
      }
  return patches;
}

std::vector<Patch> solve() {
  std::vector<Patch> patches = patches_of_box();
  const std::size_t n = patches.size();
  std::vector<float> form(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    double total = 0.0;
    for (std::size_t j = 0; j < n; ++j) {
      if (patches[i].normal == patches[j].normal) continue;
      const double f = form_factor(patches[i], patches[j]);
      form[i * n + j] = static_cast<float>(f);
      total += f;
    }
    EXPECT_NEAR(total, 1.0, 1e-4) << "the box is closed";
  }
  for (int bounce = 0; bounce < 30; ++bounce) {
    std::vector<V3f> next(n);
    for (std::size_t i = 0; i < n; ++i) {
      V3f irradiance(0.0f);
      for (std::size_t j = 0; j < n; ++j) irradiance += patches[j].radiosity * form[i * n + j];
      next[i] = patches[i].emitted + patches[i].albedo * irradiance;
    }
    for (std::size_t i = 0; i < n; ++i) patches[i].radiosity = next[i];
  }
  return patches;
}

TEST(Radiosity, ColouredBox) {
  const std::vector<Patch> patches = solve();
  Scene scene;
  for (const Wall& wall : kWalls) {
    TriangleMesh mesh;
    mesh.positions = {wall.at(-1, -1), wall.at(1, -1), wall.at(1, 1), wall.at(-1, 1)};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    add_mesh(scene, mesh, add_material(scene, MaterialType::kDiffuse, wall.albedo));
  }
  add_rectangle(scene, V3f(-kLamp, 0.9995f, -kLamp), V3f(2 * kLamp, 0, 0), V3f(0, 0, 2 * kLamp),
                kRadiance);
  constexpr int kPixels = 16;
  set_image(scene, kPixels, kPixels, 256, 40);
  scene.camera.projection = Projection::kOrthographic;
  scene.camera.height = 2.0f;
  scene.camera.position = V3f(0.0f);

  for (std::size_t w = 0; w + 1 < kWalls.size(); ++w) {  // the lamp would hide the ceiling
    const Wall& wall = kWalls[w];
    scene.camera.look_at = -wall.normal;
    scene.camera.up = wall.up();
    scene.settings.seed = static_cast<std::uint32_t>(w);
    const Film film = render(scene).film;
    // By quarters: nearer to one neighbour or to another.
    for (int quarter = 0; quarter < 4; ++quarter) {
      const int right = quarter % 2, up = quarter / 2;
      V3d expected(0.0), found(0.0), variance(0.0);
      constexpr int kHalf = kPatches / 2;
      for (int j = 0; j < kHalf; ++j)
        for (int i = 0; i < kHalf; ++i) {
          const int at = (up * kHalf + j) * kPatches + right * kHalf + i;
          expected +=
              V3d(patches[w * kPatches * kPatches + static_cast<std::size_t>(at)].radiosity) *
              (kInvPi / square(kHalf));
        }
      for (int y = 0; y < kPixels / 2; ++y)
        for (int x = 0; x < kPixels / 2; ++x) {
          const Pixel& p = film.at(x + right * kPixels / 2, y + (1 - up) * kPixels / 2);
          found += V3d(p.color) / square(kPixels / 2);
          variance += V3d(p.variance);
        }
      for (int c = 0; c < 3; ++c) {
        const double error = std::sqrt(variance[c]) / square(kPixels / 2);
        EXPECT_LT(error, 0.02 * expected[c]);
        EXPECT_NEAR(found[c], expected[c], 4.0 * error + 0.005 * expected[c])
            << wall.name << ", quarter " << quarter << ", channel " << c;
      }
    }
  }
}

}  // namespace
}  // namespace morsel::render

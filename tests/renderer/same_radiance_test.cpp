// SPDX-License-Identifier: Apache-2.0
// A hypertexture and a fine mesh of the same surface give the same light, in every material.
#include <gtest/gtest.h>

#include "hypertexture_geom/embree/geometry.h"
#include "renderer/integrator/render.h"
#include "tests/hypertexture_geom/ball_field.h"
#include "tests/hypertexture_geom/eq13.h"
#include "tests/renderer/mean_of_film.h"
#include "tests/renderer/test_scenes.h"

namespace morsel::render {
namespace {

using namespace testing;
using Shape = std::shared_ptr<const geom::HypertextureGeometry>;

// The unit sphere as the field of a sphere without noise.
Shape ball() {
  static const Shape shape = [] {
    const auto field = std::make_shared<geom::test::BallField>(V3d(0.0), 1.0);
    topology::CertifyOptions options;
    options.box = topology::Box(V3d(-1.25), V3d(1.25));
    options.min_depth = 4;
    return std::make_shared<const geom::HypertextureGeometry>(
        field, geom::test::certified_cache(*field, options), geom::GeometryOptions{});
  }();
  return shape;
}

struct Case {
  std::string name;
  Material material;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::vector<Case> cases() {
  std::vector<Case> list;
  const auto add = [&](const char* name, MaterialType type, const auto& set) {
    Material m;
    m.type = type;
    m.color = V3f(0.8f, 0.6f, 0.4f);
    m.roughness = 0.4f;
    set(m);
    list.push_back({name, m});
  };
  add("diffuse", MaterialType::kDiffuse, [](Material&) {});
  add("clay", MaterialType::kDiffuse, [](Material& m) { m.diffuse_roughness = 1.0f; });
  add("conductor", MaterialType::kConductor, [](Material&) {});
  add("mirror", MaterialType::kConductor, [](Material& m) { m.roughness = 0.0f; });
  add("glass", MaterialType::kDielectric, [](Material& m) { m.roughness = 0.0f; });
  add("rough_glass", MaterialType::kDielectric, [](Material&) {});
  add("ink", MaterialType::kDielectric, [](Material& m) {
    m.roughness = 0.0f;
    m.attenuation_distance = 1.0f;
    m.attenuation_color = V3f(0.3f, 0.5f, 0.7f);
  });
  add("plastic", MaterialType::kPrincipled, [](Material&) {});
  add("metal", MaterialType::kPrincipled, [](Material& m) { m.metallic = 1.0f; });
  add("coat", MaterialType::kPrincipled, [](Material& m) { m.clearcoat = 1.0f; });
  add("sheen", MaterialType::kPrincipled, [](Material& m) {
    m.sheen_color = V3f(0.7f);
    m.sheen_roughness = 0.5f;
  });
  add("clear", MaterialType::kPrincipled, [](Material& m) { m.transmission = 0.7f; });
  add("bubble", MaterialType::kPrincipled, [](Material& m) {
    m.transmission = 1.0f;
    m.thin = true;
  });
  add("ghost", MaterialType::kPrincipled, [](Material& m) { m.opacity = 0.4f; });
  return list;
}

class SameRadiance : public ::testing::TestWithParam<Case> {};

TEST_P(SameRadiance, OfAHypertextureSphereAndAFineMesh) {
  Mean means[2];
  for (const bool mesh : {false, true}) {
    Scene scene;
    scene.materials.push_back(GetParam().material);
    if (mesh) {
      // Vertices on a sphere lie so that the mesh has the sphere's cross section.
      add_mesh(scene, sphere_mesh(7, true), 0);
    } else {
      scene.geometries.push_back({"ball", ball()});
      Instance instance;
      instance.name = "ball";
      scene.instances.push_back(instance);
    }
    add_constant_environment(scene, 0.4f);
    add_rectangle(scene, V3f(-1, 3, 0), V3f(1.5f, 0, 0), V3f(0, 0, 1.5f), 5.0f);
    scene.camera.position = V3f(0, 1, 4);
    scene.camera.vertical_fov = 24.0f;
    set_image(scene, 40, 40, 64, 8);
    scene.settings.seed = mesh;
    means[mesh] = mean_of(render(scene).film);
  }
  const double error = std::hypot(means[0].error, means[1].error);
  EXPECT_LT(std::abs(means[0].value - means[1].value), 4.0 * error + 2e-4 * means[0].value)
      << means[0].value << " and " << means[1].value << ", standard error " << error;
  EXPECT_LT(error, 0.02 * means[0].value);
}

INSTANTIATE_TEST_SUITE_P(All, SameRadiance, ::testing::ValuesIn(cases()),
                         [](const auto& p) { return p.param.name; });

}  // namespace
}  // namespace morsel::render

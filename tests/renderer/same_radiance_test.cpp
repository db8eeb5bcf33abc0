// SPDX-License-Identifier: Apache-2.0
// A hypertexture and a fine mesh of the same surface give the same light: a sphere in every
// material, a rock of two layers pixel block by pixel block.
#include <gtest/gtest.h>

#include "hypertexture_geom/embree/geometry.h"
#include "renderer/integrator/render.h"
#include "tests/hypertexture_geom/ball_field.h"
#include "tests/hypertexture_geom/eq13.h"
#include "tests/renderer/mean_of_film.h"
#include "tests/renderer/test_scenes.h"
#include "topology/mesh/mesh.h"

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

// Distance of the mesh from the rock, whose diameter is about 2.
constexpr double kMeshError = 2e-4;

// A rock of two layers with overhangs, of which the main piece is kept, and what `morsel mesh`
// makes of it, normals included.
struct Rock {
  Shape hypertexture;
  TriangleMesh mesh;
};
const Rock& rock() {
  static const Rock made = [] {
    const nlohmann::json json = nlohmann::json::parse(R"({
      "name": "rock", "type": "hypertexture",
      "field": { "density": { "type": "sphere", "radius": 1 },
                 "modulations": [{ "type": "fbm", "noise": "sparse_convolution", "amplitude": 0.6,
                                   "frequency": 1.5, "layers": 2, "seed": 5 }] } })");
    const geom::Hypertexture h = geom::hypertexture_from_json(json, {"rock", ""});
    const auto cache = std::make_shared<const topology::TopologyCache>(geom::build_cache(h));
    const auto kept =
        topology::kept_components(h.keep, cache->topology.components, cache->topology.octree());
    topology::MeshOptions options;
    options.error = kMeshError;
    const topology::Mesh mesh =
        topology::extract_mesh(*h.field, cache->topology.octree(), kept, options);
    EXPECT_TRUE(mesh.certified);
    EXPECT_GT(cache->topology.components.size(), 1u) << "nothing is removed from this rock";
    Rock r;
    for (const V3d& p : mesh.positions) r.mesh.positions.emplace_back(p);
    r.mesh.normals = mesh.normals;
    for (const auto& t : mesh.triangles)
      r.mesh.triangles.emplace_back(static_cast<int>(t[0]), static_cast<int>(t[1]),
                                    static_cast<int>(t[2]));
    r.hypertexture =
        std::make_shared<const geom::HypertextureGeometry>(h.field, cache, geom::GeometryOptions{});
    return r;
  }();
  return made;
}

class RockRadiance : public ::testing::TestWithParam<Case> {};

TEST_P(RockRadiance, IsThatOfItsMesh) {
  constexpr int kSize = 64, kBlock = 8;
  std::vector<Film> films;
  for (const bool mesh : {false, true}) {
    Scene scene;
    scene.materials.push_back(GetParam().material);
    if (mesh)
      scene.geometries.push_back({"mesh", rock().mesh});
    else
      scene.geometries.push_back({"rock", rock().hypertexture});
    Instance instance;
    instance.name = "rock";
    scene.instances.push_back(instance);
    add_constant_environment(scene, 0.3f);
    add_rectangle(scene, V3f(-1, 3, 0), V3f(2, 0, 0), V3f(0, 0, 2), 6.0f);
    scene.camera.position = V3f(0, 1, 5);
    scene.camera.vertical_fov = 34.0f;
    set_image(scene, kSize, kSize, 256, 8);
    scene.settings.seed = mesh;
    films.push_back(render(scene).film);
  }
  const Mean whole[] = {mean_of(films[0]), mean_of(films[1])};
  const double error = std::hypot(whole[0].error, whole[1].error);
  // What a surface that is off by the mesh's error changes, at most, is of its order.
  EXPECT_LT(std::abs(whole[0].value - whole[1].value), 4.0 * error + kMeshError * whole[0].value)
      << whole[0].value << " and " << whole[1].value << ", standard error " << error;
  EXPECT_LT(error, 0.005 * whole[0].value);

  // Block by block: z values that have, squared, the mean 1.
  double squares = 0.0, worst = 0.0;
  int blocks = 0;
  for (int y = 0; y < kSize; y += kBlock)
    for (int x = 0; x < kSize; x += kBlock) {
      const Crop window{x, y, x + kBlock, y + kBlock};
      const Mean a = mean_of(films[0], window), b = mean_of(films[1], window);
      const double sigma = std::hypot(a.error, b.error);
      if (!(sigma > 0.0)) continue;  // the plain background
      const double z = (a.value - b.value) / sigma;
      squares += z * z;
      worst = std::max(worst, std::abs(z));
      ++blocks;
    }
  ASSERT_GT(blocks, 20);
  EXPECT_LT(worst, 5.0);
  EXPECT_LT(squares / blocks, 1.0 + 5.0 * std::sqrt(2.0 / blocks));
  RecordProperty("mean_square_z", std::to_string(squares / blocks));
}

INSTANTIATE_TEST_SUITE_P(Some, RockRadiance, ::testing::ValuesIn([] {
                           std::vector<Case> some;
                           for (const Case& c : cases())
                             if (c.name == "clay" || c.name == "metal" || c.name == "plastic" ||
                                 c.name == "rough_glass")
                               some.push_back(c);
                           return some;
                         }()),
                         [](const auto& p) { return p.param.name; });

}  // namespace
}  // namespace morsel::render

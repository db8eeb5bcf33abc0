// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <utility>

#include "renderer/math/vector.h"
#include "renderer/scene/scene.h"

// Small scenes made in memory.
namespace morsel::render::testing {

// A unit sphere of 20 * 4^levels triangles, wound outward; vertices are on the sphere.
inline TriangleMesh sphere_mesh(int levels, bool smooth = false) {
  TriangleMesh mesh;
  const float g = 0.5f * (1.0f + std::sqrt(5.0f));
  for (const V3f& v :
       {V3f(-1, g, 0), V3f(1, g, 0), V3f(-1, -g, 0), V3f(1, -g, 0), V3f(0, -1, g), V3f(0, 1, g),
        V3f(0, -1, -g), V3f(0, 1, -g), V3f(g, 0, -1), V3f(g, 0, 1), V3f(-g, 0, -1), V3f(-g, 0, 1)})
    mesh.positions.push_back(normalize(v));
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto key = std::minmax(a, b);
      const auto found = middles.find(key);
      if (found != middles.end()) return found->second;
      const int index = static_cast<int>(mesh.positions.size());
      mesh.positions.push_back(normalize(mesh.positions[static_cast<std::size_t>(a)] +
                                         mesh.positions[static_cast<std::size_t>(b)]));
      return middles[key] = index;
    };
    std::vector<Imath::V3i> finer;
    for (const Imath::V3i& t : mesh.triangles) {
      const int a = middle(t.x, t.y), b = middle(t.y, t.z), c = middle(t.z, t.x);
      finer.insert(finer.end(), {{t.x, a, c}, {t.y, b, a}, {t.z, c, b}, {a, b, c}});
    }
    mesh.triangles = std::move(finer);
  }
  if (smooth) mesh.normals = mesh.positions;
  return mesh;
}

// The square |x|, |z| <= half_size at height y, facing +y.
inline TriangleMesh plane_mesh(float half_size, float y = 0.0f) {
  TriangleMesh mesh;
  const float s = half_size;
  mesh.positions = {{-s, y, -s}, {-s, y, s}, {s, y, s}, {s, y, -s}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

inline std::uint32_t add_material(Scene& scene, MaterialType type, const V3f& color,
                                  float roughness = 0.0f) {
  Material m;
  m.type = type;
  m.color = color;
  m.roughness = roughness;
  scene.materials.push_back(m);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

inline void add_mesh(Scene& scene, TriangleMesh mesh, std::uint32_t material,
                     const Imath::M44d& object_to_world = Imath::M44d()) {
  scene.geometries.push_back({"mesh", std::move(mesh)});
  Instance instance;
  instance.name = "instance";
  instance.geometry = static_cast<std::uint32_t>(scene.geometries.size() - 1);
  instance.material = material;
  instance.object_to_world = object_to_world;
  scene.instances.push_back(instance);
}

inline void add_constant_environment(Scene& scene, float radiance) {
  scene.environment.emplace();
  scene.environment->radiance = V3f(radiance);
}

inline void add_rectangle(Scene& scene, const V3f& corner, const V3f& u, const V3f& v,
                          float radiance) {
  RectangleLight light;
  light.name = "rectangle";
  light.corner = corner;
  light.edge_u = u;
  light.edge_v = v;
  light.radiance = V3f(radiance);
  scene.rectangles.push_back(light);
}

inline void set_image(Scene& scene, int width, int height, int spp, int max_depth = 8) {
  scene.settings.width = width;
  scene.settings.height = height;
  scene.settings.spp = spp;
  scene.settings.max_depth = max_depth;
}

inline Imath::M44d scaled(double x, double y, double z) {
  Imath::M44d m;
  m[0][0] = x;
  m[1][1] = y;
  m[2][2] = z;
  return m;
}
inline Imath::M44d translated(double x, double y, double z) {
  Imath::M44d m;
  m[3][0] = x;
  m[3][1] = y;
  m[3][2] = z;
  return m;
}
inline Imath::M44d rotated_y(double degrees) {
  Imath::M44d m;
  const double a = degrees * 3.14159265358979323846 / 180.0;
  m[0][0] = m[2][2] = std::cos(a);
  m[0][2] = -std::sin(a);
  m[2][0] = std::sin(a);
  return m;
}

// All pixels see the unit sphere at the origin.
inline void look_at_sphere(Scene& scene) {
  scene.camera.position = V3f(0, 0, 4);
  scene.camera.vertical_fov = 20.0f;
}

// Everything at once: diffuse floor, rough metal, rough glass, an environment, a rectangle.
inline Scene mixed_scene() {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.7f, 0.6f, 0.5f));
  add_material(scene, MaterialType::kConductor, V3f(0.9f, 0.7f, 0.4f), 0.4f);
  add_material(scene, MaterialType::kDielectric, V3f(0.9f), 0.5f);
  scene.materials[0].checker_color = V3f(0.2f);
  add_mesh(scene, plane_mesh(6.0f, -1.0f), 0);
  add_mesh(scene, sphere_mesh(3, true), 1, translated(-1.2, 0, 0));
  add_mesh(scene, sphere_mesh(3, true), 2, translated(1.2, 0, 0));
  add_constant_environment(scene, 0.3f);
  add_rectangle(scene, V3f(-1, 3, -1), V3f(2, 0, 0), V3f(0, 0, 2), 8.0f);
  scene.camera.position = V3f(0, 2, 6);
  scene.camera.vertical_fov = 35.0f;
  set_image(scene, 48, 32, 64, 4);
  return scene;
}

}  // namespace morsel::render::testing

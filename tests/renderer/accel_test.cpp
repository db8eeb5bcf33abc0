// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "renderer/accel/scene_accel.h"
#include "renderer/accel/spawn.h"
#include "renderer/material/surface_frame.h"
#include "tests/renderer/statistics.h"
#include "tests/renderer/test_scenes.h"

namespace morsel::render {
namespace {

using namespace testing;

struct Placement {
  const char* name;
  Imath::M44d transform;
};
void PrintTo(const Placement& p, std::ostream* out) { *out << p.name; }

class PlacedSphere : public ::testing::TestWithParam<Placement> {
 protected:
  PlacedSphere() {
    add_material(scene_, MaterialType::kDiffuse, V3f(0.5f));
    add_mesh(scene_, sphere_mesh(3), 0, GetParam().transform);
  }
  V3f centre() const { return V3f(V3d(0.0) * GetParam().transform); }
  V3f on_sphere(const V3f& w) const { return V3f(V3d(w) * GetParam().transform); }

  Scene scene_;
};

// The body is convex: what leaves the front never comes back, what goes in must come out. Any
// self-intersection would show as a hit right at the start.
TEST_P(PlacedSphere, SpawnedRaysNeverHitTheirOwnSurface) {
  const SceneAccel accel(scene_);
  const FlushDenormals flush;
  Random random;
  const V3f c = centre();
  int hits = 0, inward = 0, lost = 0;
  for (int i = 0; i < 20000; ++i) {
    const V3f w = random.direction();
    Ray ray;
    ray.origin = c + (on_sphere(w) - c) * 3.0f;
    ray.direction = on_sphere(random.direction() * 0.7f) - ray.origin;
    SurfaceInteraction s;
    if (!accel.intersect(ray, RayKind::kBounce, s)) continue;
    ++hits;
    ASSERT_LT(dot(ray.direction, s.geometric_normal), 0.0f) << "normals point out";
    for (int k = 0; k < 4; ++k) {
      V3f d = random.direction();
      if (k == 0) d = normalize(d - s.geometric_normal * (0.999f * dot(d, s.geometric_normal)));
      const bool out = dot(d, s.geometric_normal) > 0.0f;
      Ray spawned;
      spawned.origin = s.spawn(d);
      spawned.direction = d;
      SurfaceInteraction next;
      const bool hit = accel.intersect(spawned, RayKind::kBounce, next);
      ASSERT_EQ(hit, accel.occluded(spawned));
      if (out) {
        ASSERT_FALSE(hit) << "sample " << i << ", prim " << s.primitive << " t " << next.t;
      } else if (dot(d, s.geometric_normal) < -0.05f) {
        ++inward;
        lost += !hit;
        if (hit) {
          ASSERT_NE(next.primitive, s.primitive);
        }
      }
    }
  }
  EXPECT_GT(hits, 10000);
  // Right at a sharp edge the way in may end on the other side of the next triangle.
  EXPECT_LT(lost, 2e-4 * inward);
}

TEST_P(PlacedSphere, SpawnPointsAreCloseToTheSurface) {
  const SceneAccel accel(scene_);
  Random random;
  const V3f c = centre();
  for (int i = 0; i < 1000; ++i) {
    Ray ray;
    ray.origin = c + (on_sphere(random.direction()) - c) * 3.0f;
    ray.direction = c - ray.origin;
    SurfaceInteraction s;
    ASSERT_TRUE(accel.intersect(ray, RayKind::kBounce, s));
    const float scale = max_abs(c) + max_abs(ray.origin - c);
    EXPECT_LT((s.spawn_front - s.p).length(), 2e-4f * scale);
    EXPECT_GT(dot(s.spawn_front - s.spawn_behind, s.geometric_normal), 0.0f);
    EXPECT_NEAR((s.p - (ray.origin + ray.direction * s.t)).length(), 0.0f, 1e-5f * scale);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Everywhere, PlacedSphere,
    ::testing::Values(
        Placement{"origin", Imath::M44d()}, Placement{"far", translated(1000, -2000, 500)},
        Placement{"small", scaled(1e-3, 1e-3, 1e-3)}, Placement{"large", scaled(1e4, 1e4, 1e4)},
        Placement{"mirrored", scaled(-1, 1, 1) * translated(3, 0, 0)},
        Placement{"flat", scaled(2, 0.05, 1) * rotated_y(30) * translated(20, 0, 7)},
        Placement{"mirrored_flat_far",
                  rotated_y(50) * scaled(1, -0.2, 3) * rotated_y(10) * translated(300, 100, -70)}),
    [](const auto& p) { return std::string(p.param.name); });

TEST(SceneAccel, FillsInTheInteraction) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.5f));
  add_material(scene, MaterialType::kDiffuse, V3f(0.5f));
  TriangleMesh plane = plane_mesh(1.0f);
  plane.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  plane.normals.assign(4, normalize(V3f(0.3f, 1.0f, 0.0f)));
  add_mesh(scene, sphere_mesh(1), 0, translated(0, 50, 0));
  add_mesh(scene, plane, 1, scaled(2, 1, 1));
  const SceneAccel accel(scene);
  Ray ray;
  ray.origin = V3f(1.0f, 4.0f, 0.5f);
  ray.direction = V3f(0.0f, -2.0f, 0.0f);  // not a unit vector
  SurfaceInteraction s;
  ASSERT_TRUE(accel.intersect(ray, RayKind::kCamera, s));
  EXPECT_FLOAT_EQ(s.t, 2.0f);
  EXPECT_NEAR((s.p - V3f(1, 0, 0.5f)).length(), 0.0f, 1e-6f);
  EXPECT_EQ(s.instance, 1u);
  EXPECT_EQ(s.geometry, 1u);
  EXPECT_EQ(s.material, 1u);
  EXPECT_EQ(s.light, kNoIndex);
  EXPECT_EQ(s.component, kNoIndex);
  EXPECT_LT(s.primitive, 2u);
  EXPECT_NEAR((s.uv - V2f(0.75f, 0.75f)).length(), 0.0f, 1e-6f);
  EXPECT_EQ(s.geometric_normal, V3f(0, 1, 0));
  // Inverse transpose: stretching by 2 along x halves the normal's x before normalising.
  EXPECT_NEAR((s.shading_normal - normalize(V3f(0.15f, 1, 0))).length(), 0.0f, 1e-6f);

  // What the hit brings along for texture coordinates is what the scene has.
  const SurfaceFrame at_hand = surface_frame(scene, s);
  s.transform = nullptr;
  const SurfaceFrame looked_up = surface_frame(scene, s);
  EXPECT_EQ(at_hand.u_tangent, V3f(4, 0, 0));
  EXPECT_EQ(at_hand.u_tangent, looked_up.u_tangent);
  EXPECT_EQ(at_hand.v_gradient, looked_up.v_gradient);

  ray.tfar = 1.9f;
  EXPECT_FALSE(accel.intersect(ray, RayKind::kCamera, s));
  EXPECT_FALSE(accel.occluded(ray));
  ray.tfar = 2.1f;
  EXPECT_TRUE(accel.occluded(ray));
  EXPECT_EQ(accel.statistics().triangles, 82u);
  EXPECT_GT(accel.statistics().bytes, 0u);
}

TEST(SceneAccel, LightsAreGeometryThatMayHideFromTheCamera) {
  Scene scene;
  add_rectangle(scene, V3f(-1, 1, -1), V3f(2, 0, 0), V3f(0, 0, 2), 1.0f);
  add_rectangle(scene, V3f(-1, 2, -1), V3f(2, 0, 0), V3f(0, 0, 2), 1.0f);
  scene.rectangles[0].visible_to_camera = false;
  const SceneAccel accel(scene);
  Ray ray;
  ray.origin = V3f(0.0f);
  ray.direction = V3f(0, 1, 0);
  SurfaceInteraction s;
  ASSERT_TRUE(accel.intersect(ray, RayKind::kBounce, s));
  EXPECT_EQ(s.light, 0u);
  EXPECT_EQ(s.instance, kNoIndex);
  EXPECT_EQ(s.geometric_normal, V3f(0, -1, 0));
  EXPECT_TRUE(accel.occluded(ray));
  ASSERT_TRUE(accel.intersect(ray, RayKind::kCamera, s));
  EXPECT_EQ(s.light, 1u);
}

TEST(SceneAccel, InstancesShareGeometryAndUnusedGeometryIsNotBuilt) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.5f));
  add_mesh(scene, sphere_mesh(2), 0);
  Instance other = scene.instances[0];
  other.object_to_world = translated(5, 0, 0);
  scene.instances.push_back(other);
  scene.geometries.push_back({"unused", TriangleMesh{}});
  const SceneAccel accel(scene);
  EXPECT_EQ(accel.statistics().triangles, 320u);
  Ray ray;
  ray.origin = V3f(5, 0, 5);
  ray.direction = V3f(0, 0, -1);
  SurfaceInteraction s;
  ASSERT_TRUE(accel.intersect(ray, RayKind::kCamera, s));
  EXPECT_EQ(s.instance, 1u);
  EXPECT_EQ(s.geometry, 0u);
}

TEST(SceneAccel, SaysWhatIsWrong) {
  const auto message = [](const Scene& scene) -> std::string {
    try {
      const SceneAccel accel(scene);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  Scene good;
  add_material(good, MaterialType::kDiffuse, V3f(0.5f));
  add_mesh(good, plane_mesh(1), 0);
  EXPECT_EQ(message(good), "");

  Scene scene = good;
  std::get<TriangleMesh>(scene.geometries[0].shape).triangles[1].y = 4;
  EXPECT_EQ(message(scene), "mesh 'mesh': triangle 1 has vertex 4 of 4");
  scene = good;
  std::get<TriangleMesh>(scene.geometries[0].shape).normals.resize(3);
  EXPECT_EQ(message(scene), "mesh 'mesh': 3 normals for 4 vertices");
  scene = good;
  scene.instances[0].material = 7;
  EXPECT_EQ(message(scene), "instance 'instance': material 7 of 1");
  scene = good;
  scene.instances[0].object_to_world = scaled(1, 0, 1);
  EXPECT_EQ(message(scene), "instance 'instance': its transform is not invertible");
  scene = good;
  scene.instances[0].object_to_world = translated(NAN, 0, 0);
  EXPECT_EQ(message(scene), "instance 'instance': its transform is not finite");
}

TEST(Spawn, RoundsAwayFromTheSurface) {
  Random random;
  for (int i = 0; i < 10000; ++i) {
    const V3d p = V3d(random.direction()) * 1000.0 * static_cast<double>(random());
    const V3d n(random.direction());
    const V3f moved = moved_outward(p, n, 1e-12);
    for (int k = 0; k < 3; ++k)
      EXPECT_GE((static_cast<double>(moved[k]) - p[k]) * (n[k] > 0 ? 1.0 : -1.0), 0.0);
  }
}

// The float next to a number on the side that the direction points to, or the number itself.
TEST(Spawn, PointsAreRoundedAwayFromTheSurface) {
  Random random;
  const auto uniform = [&] { return 2.0 * (random() + 0x1p-24 * random()) - 1.0; };
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (int i = 0; i < 100000; ++i) {
    const double scale = std::ldexp(1.0, i % 41 - 20);
    const double x = i % 3 == 0 ? static_cast<float>(uniform() * scale)  // needs no rounding
                                : uniform() * scale;
    const double direction = uniform();
    const float r = rounded_towards(x, direction), opposite = rounded_towards(x, -direction);
    const float above = direction > 0.0 ? r : opposite, below = direction > 0.0 ? opposite : r;
    ASSERT_TRUE(above >= x && std::nextafter(above, -kInf) < x) << x;
    ASSERT_TRUE(below <= x && std::nextafter(below, kInf) > x) << x;
    ASSERT_EQ(rounded_towards(x, 0.0), static_cast<float>(x));
  }
  EXPECT_GT(rounded_towards(1e-60, 1.0), 0.0f);
  EXPECT_LT(rounded_towards(-1e-60, -1.0), 0.0f);
  EXPECT_EQ(rounded_towards(0.0, 1.0), 0.0f);
}

}  // namespace
}  // namespace morsel::render

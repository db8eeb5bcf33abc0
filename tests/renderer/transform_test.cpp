// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/transform.h"

#include <gtest/gtest.h>

#include "renderer/scene/readers.h"

namespace morsel::render {
namespace {

using Imath::V3d;
using nlohmann::json;

V3d moved(const Imath::M44d& m, const V3d& p) {
  V3d result;
  m.multVecMatrix(p, result);
  return result;
}

void expect_near(const V3d& a, const V3d& b) { EXPECT_NEAR((a - b).length(), 0, 1e-12) << a << b; }

TEST(Transform, ScalesThenRotatesThenTranslates) {
  const Imath::M44d m = make_transform({2, 1, 1}, {0, 0, 90}, {10, 0, 0});
  EXPECT_EQ(moved(m, {1, 0, 0}), V3d(10, 2, 0));  // right angles are exact
  EXPECT_EQ(moved(m, {0, 1, 0}), V3d(9, 0, 0));
}

TEST(Transform, PositiveAnglesTurnCounterClockwise) {
  EXPECT_EQ(moved(make_transform(V3d(1), {90, 0, 0}, V3d(0)), {0, 1, 0}), V3d(0, 0, 1));
  EXPECT_EQ(moved(make_transform(V3d(1), {0, 90, 0}, V3d(0)), {0, 0, 1}), V3d(1, 0, 0));
  EXPECT_EQ(moved(make_transform(V3d(1), {0, 0, 90}, V3d(0)), {1, 0, 0}), V3d(0, 1, 0));
}

TEST(Transform, RotatesAboutXThenYThenZ) {
  const V3d p(0.3, -1.1, 0.7);
  const V3d at_once = moved(make_transform(V3d(1), {20, 50, -70}, V3d(0)), p);
  V3d step = moved(make_transform(V3d(1), {20, 0, 0}, V3d(0)), p);
  step = moved(make_transform(V3d(1), {0, 50, 0}, V3d(0)), step);
  step = moved(make_transform(V3d(1), {0, 0, -70}, V3d(0)), step);
  expect_near(at_once, step);
}

TEST(Transform, MatrixIsForColumnVectors) {
  const json rows = {{1, 2, 3, 4}, {0, 5, 6, 7}, {0, 0, 8, 9}, {0, 0, 0, 1}};
  const Imath::M44d m = read_transform(rows, {"file", ""});
  EXPECT_EQ(moved(m, {1, 1, 1}), V3d(10, 18, 17));
}

TEST(Transform, FlatOnesAreNoticedAtAnyScale) {
  EXPECT_TRUE(is_invertible(make_transform(V3d(1e-6), V3d(30), V3d(1e6))));
  EXPECT_TRUE(is_invertible(make_transform(V3d(1e6, 1e-3, -1), V3d(30), V3d(0))));
  EXPECT_FALSE(is_invertible(make_transform({1, 0, 1}, V3d(30), V3d(0))));
  const json rows = {{1, 2, 3, 0}, {2, 4, 6, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  EXPECT_THROW(read_transform(rows, {"file", ""}), params::InputError);
}

TEST(RectangleLight, ByItsCentreFacesThePoint) {
  Scene scene;
  read_light({{"type", "rectangle"},
              {"position", {1, 4, 2}},
              {"look_at", {1, 0, 2}},
              {"size", {3, 2}},
              {"radiance", {1, 2, 3}}},
             {"file", ""}, scene);
  read_light(
      {{"type", "rectangle"}, {"position", {5, 5, 5}}, {"look_at", {0, 0, 0}}, {"size", {1, 1}}},
      {"file", ""}, scene);
  const RectangleLight &light = scene.rectangles.at(0), &slanted = scene.rectangles.at(1);
  const Imath::V3f normal = light.edge_u.cross(light.edge_v);
  EXPECT_NEAR((normal.normalized() - Imath::V3f(0, -1, 0)).length(), 0, 1e-6);
  EXPECT_NEAR(normal.length(), 6, 1e-5);
  EXPECT_NEAR((light.corner + (light.edge_u + light.edge_v) / 2 - Imath::V3f(1, 4, 2)).length(), 0,
              1e-6);
  const Imath::V3f facing = slanted.edge_u.cross(slanted.edge_v).normalized();
  EXPECT_NEAR((facing - Imath::V3f(-1, -1, -1).normalized()).length(), 0, 1e-6);
  EXPECT_NEAR(slanted.edge_u.y, 0, 1e-6);  // level
}

}  // namespace
}  // namespace morsel::render

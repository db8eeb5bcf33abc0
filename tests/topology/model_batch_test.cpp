// SPDX-License-Identifier: Apache-2.0
// Eight models at once say what eight models one by one say.
#include "topology/model_batch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/hypertexture_geom/test_fields.h"
#include "topology/cascade.h"
#include "topology/scalar_field.h"

namespace morsel::topology {
namespace {

// a x + b x^2 is least at -a / (2 b), where it is -a^2 / (4 b): the square underflows, the value
// not.
TEST(LocalModelRange, HoldsWhereTheSquareOfASlopeUnderflows) {
  LocalModel model;
  model.half = Imath::V3d(1e-5);
  model.c[monomial::kX] = 1e-170;
  model.c[monomial::kXX] = 1e-164;
  EXPECT_LE(model.range().lo, -2.49e-177);
  EXPECT_GE(model.range().lo, -1e-175);
}

// Boxes with planes on a dyadic grid, wider and narrower than the kernels, at the origin and far
// from it; `surface` says how far from the sphere of radius 1 the centres may be.
Box random_box(std::mt19937_64& random, double surface) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Imath::V3d direction;
  do {
    direction = Imath::V3d(unit(random), unit(random), unit(random));
  } while (direction.length() < 0.1);
  const double size = std::ldexp(1.0, -static_cast<int>(random() % 16));
  const Imath::V3d c = direction.normalized() * (1.0 + surface * unit(random));
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min[axis] = std::floor(c[axis] / size) * size;
    box.max[axis] = box.min[axis] + size;
  }
  return box;
}

const nlohmann::json kFields[] = {
    geom::testing::eq13_json(1, 1),
    geom::testing::eq13_json(3, 5),
    {{"density", {{"type", "sphere"}, {"radius", 1.0}}}},
    // No batches of their own: the plain loop.
    {{"density", {{"type", "torus"}, {"major_radius", 1.0}, {"minor_radius", 0.3}}}}};

TEST(ModelBatch, AgreesWithSingleModels) {
  std::mt19937_64 random(7);
  for (const nlohmann::json& description : kFields) {
    const auto field = geom::testing::field_of(description);
    for (int n = 0; n < 300; ++n) {
      const Box box = random_box(random, 0.5);
      const auto local = field->restricted_to(box);
      ModelBatch batch;
      local->child_models(box, 0xffu, batch);
      for (int i = 0; i < 8; ++i) {
        const Box child = child_box(box, i);
        const LocalModel one = local->model(child), other = batch[i];
        EXPECT_EQ(one.centre, other.centre);
        EXPECT_EQ(one.half, other.half);
        // As polynomials on the box: monomial by monomial, against the size of them all.
        const double h = one.half.x;
        const double powers[4] = {1.0, h, h * h, h * h * h};
        double size = 0.0, off = 0.0;
        for (int k = 0; k < monomial::kCount; ++k) {
          const double power = powers[k == 0 ? 0 : k < 4 ? 1 : k < 10 ? 2 : 3];
          const auto at = static_cast<std::size_t>(k);
          size += std::abs(one.c[at]) * power;
          off = std::max(off, std::abs(one.c[at] - other.c[at]) * power);
        }
        EXPECT_LE(off, 1e-12 * (size + 1.0)) << description << " box of " << 2.0 * h;
        // Rounding allowances differ a little, which shows on boxes much wider than the kernels.
        const auto close = [](double a, double b) {
          return a == b || std::abs(a - b) <= 1e-5 * std::max(a, b) + 1e-10;
        };
        EXPECT_TRUE(close(one.value_error, other.value_error))
            << one.value_error << " " << other.value_error;
        for (int axis = 0; axis < 3; ++axis)
          EXPECT_TRUE(close(one.gradient_error[axis], other.gradient_error[axis]))
              << one.gradient_error[axis] << " " << other.gradient_error[axis];
        // Rounding of second derivatives grows with the finest layer's frequency squared.
        EXPECT_TRUE(close(one.hessian_error, other.hessian_error) ||
                    std::abs(one.hessian_error - other.hessian_error) < 1e-8)
            << one.hessian_error << " " << other.hessian_error;
      }
    }
  }
}

// The bounds of every lane hold at points of the box, at its corners too.
TEST(ModelBatch, BoundsHold) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const nlohmann::json& description : kFields) {
    const auto field = geom::testing::field_of(description);
    for (int n = 0; n < 150; ++n) {
      const Box box = random_box(random, 0.5);
      const auto local = field->restricted_to(box);
      ModelBatch batch;
      local->child_models(box, 0xffu, batch);
      for (int i = 0; i < 8; ++i) {
        const LocalModel m = batch[i];
        for (int k = 0; k < 16; ++k) {
          Imath::V3d u(unit(random), unit(random), unit(random));
          if (k < 8) u = Imath::V3d(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
          u *= m.half;
          const Jet jet = local->jet(m.centre + u);
          const Imath::V3d gradient = m.gradient_at(u);
          EXPECT_LE(std::abs(jet.value - m.value_at(u)), m.value_error + 1e-14) << description;
          for (int axis = 0; axis < 3; ++axis)
            EXPECT_LE(std::abs(jet.gradient[axis] - gradient[axis]), m.gradient_error[axis] + 1e-12)
                << description;
        }
      }
    }
  }
}

// A field that was restricted level by level says as much as the field itself: what is carried from
// level to level is off by rounding only.
TEST(ModelBatch, NothingIsLostFromLevelToLevel) {
  std::mt19937_64 random(13);
  for (const int layers : {1, 3, 5}) {
    const auto field = geom::testing::field_of(geom::testing::eq13_json(layers, 2));
    for (int n = 0; n < 30; ++n) {
      const Imath::V3d towards = centre(random_box(random, 0.5));
      Box box(Imath::V3d(-4.0), Imath::V3d(4.0));
      std::unique_ptr<ScalarField> local = field->restricted_to(box);
      for (int level = 0; level < 24; ++level) {
        const Imath::V3d middle = centre(box);
        box = child_box(
            box, (towards.x > middle.x) + 2 * (towards.y > middle.y) + 4 * (towards.z > middle.z));
        local = local->restricted_to(box);
        EXPECT_NEAR(local->value(towards), field->value(towards), 1e-13);
        if (level < 6) continue;
        ModelBatch batch;
        local->child_models(box, 0xffu, batch);
        for (int i = 0; i < 8; i += 3) {
          const LocalModel one = field->model(child_box(box, i)), other = batch[i];
          EXPECT_LE(other.value_error, 1.0001 * one.value_error + 1e-9) << level;
          for (int axis = 0; axis < 3; ++axis)
            EXPECT_LE(other.gradient_error[axis], 1.0001 * one.gradient_error[axis] + 1e-7)
                << level;
          EXPECT_LE(other.hessian_error, 1.0001 * one.hessian_error + 1e-5) << level;
        }
      }
    }
  }
}

// Two proofs about one set cannot contradict: one that says more than the other is fine.
bool contradict(Content a, Content b) {
  if (a == Content::kUndecided || b == Content::kUndecided) return false;
  return (a == Content::kEmpty) != (b == Content::kEmpty);
}

TEST(ModelBatch, CascadesAgree) {
  std::mt19937_64 random(3);
  int cells = 0, same = 0, faces = 0, same_faces = 0, decided = 0;
  for (const nlohmann::json& description : kFields) {
    const auto field = geom::testing::field_of(description);
    for (int n = 0; n < 400; ++n) {
      const Box box = random_box(random, 0.3);
      const auto local = field->restricted_to(box);
      ModelBatch batch;
      local->child_models(box, 0xffu, batch);
      BatchContent content;
      classify_batch(batch, 0xffu, content);
      classify_batch_faces(batch, 0xffu, content);
      for (int i = 0; i < 8; ++i) {
        const LocalModel model = local->model(child_box(box, i));
        const Content one = classify(model);
        EXPECT_FALSE(contradict(one, content.cell[i])) << description;
        ++cells;
        same += one == content.cell[i];
        decided += one == Content::kConnected;
        OctreeNode node, other;
        classify_faces(model, node);
        other.faces = content.faces[i];
        for (int axis = 0; axis < 3; ++axis)
          for (int side = 0; side < 2; ++side) {
            const Content a = node.face_content(axis, side), b = other.face_content(axis, side);
            EXPECT_FALSE(contradict(a, b)) << description;
            ++faces;
            same_faces += a == b;
          }
      }
    }
  }
  EXPECT_GT(decided, 100);
  EXPECT_GT(same, cells * 995 / 1000);
  EXPECT_GT(same_faces, faces * 98 / 100);
}

// Lanes that were not asked for stay as they were.
TEST(ModelBatch, OnlyWantedLanesAreClassified) {
  const auto field = geom::testing::field_of(geom::testing::eq13_json(1, 1));
  const Box box(Imath::V3d(0.5), Imath::V3d(1.0));
  ModelBatch batch;
  field->child_models(box, 0xffu, batch);
  BatchContent all, some;
  classify_batch(batch, 0xffu, all);
  for (Content& c : some.cell) c = Content::kConnected;
  classify_batch(batch, 0b00100101u, some);
  for (int i = 0; i < 8; ++i)
    EXPECT_EQ(some.cell[i], (0b00100101 >> i) & 1 ? all.cell[i] : Content::kConnected);
}

TEST(ModelBatch, WhatOverflowsSaysNothing) {
  ModelBatch batch;
  batch.start(Box(Imath::V3d(-1.0), Imath::V3d(1.0)));
  for (int i = 0; i < 8; ++i) batch.c[0][i] = 1.0;
  batch.c[0][1] = std::nan("");
  batch.c[7][2] = HUGE_VAL;
  batch.value_error[3] = std::nan("");
  batch.value_error[4] = HUGE_VAL;
  batch.c[12][5] = 1e300;
  BatchContent content;
  classify_batch(batch, 0xffu, content);
  classify_batch_faces(batch, 0xffu, content);
  for (int i = 0; i < 8; ++i) {
    const bool broken = i >= 1 && i <= 5;
    EXPECT_EQ(content.cell[i], broken ? Content::kUndecided : Content::kFull) << i;
    EXPECT_EQ(content.faces[i], broken ? 0xfff : 0xaaa) << i;
  }
}

}  // namespace
}  // namespace morsel::topology

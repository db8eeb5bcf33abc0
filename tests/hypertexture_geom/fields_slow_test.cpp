// SPDX-License-Identifier: Apache-2.0
// Eight fields, 10^6 rays each (or as many as the environment's MORSEL_RAYS says) against a dense
// march with certified labels; the three solvers and the paper's streamline filter beside. Fields
// with many octaves are looked at in a part of their box, whose topology takes seconds.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/hypertexture_geom/rays_against_march.h"
#include "tests/hypertexture_geom/test_fields.h"

namespace morsel::geom {
namespace {

using nlohmann::json;

int rays() {
  const char* text = std::getenv("MORSEL_RAYS");
  return text ? std::max(1000, std::atoi(text)) : 1000000;
}

Hypertexture hypertexture(const json& field, const json& bounds = nullptr) {
  json geometry{{"name", "rock"}, {"type", "hypertexture"}, {"field", field}};
  if (!bounds.is_null()) geometry["bounds"] = bounds;
  return hypertexture_from_json(geometry, {"fields_slow_test", ""});
}

// The part of the box around `centre`.
Hypertexture part(const json& field, const Imath::V3d& centre, double half) {
  Hypertexture rock = hypertexture(field);
  rock.certify.box = topology::dyadic_box({centre - Imath::V3d(half), centre + Imath::V3d(half)});
  return rock;
}

TEST(FieldsSlow, SparseConvolution1) {
  test::compare_with_march(hypertexture(testing::eq13_json(1, 1)), 1.0 / 3, rays(),
                           {.solvers = true, .streamline = true});
}
TEST(FieldsSlow, SparseConvolution2) {
  test::compare_with_march(hypertexture(testing::eq13_json(2, 2)), 1.0 / 6, rays(),
                           {.solvers = true});
}
TEST(FieldsSlow, SparseConvolution3) {
  test::compare_with_march(part(testing::eq13_json(3, 3), {0.8, 0.6, 0.4}, 0.6), 1.0 / 12, rays(),
                           {.solvers = true});
}
TEST(FieldsSlow, SparseConvolution4) {
  test::compare_with_march(part(testing::eq13_json(4, 4), {-0.8, 0.6, 0.2}, 0.35), 1.0 / 24, rays(),
                           {.solvers = true});
}
TEST(FieldsSlow, Perlin1) {
  test::compare_with_march(hypertexture(testing::perlin_json(1, 5, 1.6, 4.0)), 0.25, rays(),
                           {.solvers = true, .streamline = true});
}
TEST(FieldsSlow, Perlin3) {
  test::compare_with_march(part(testing::perlin_json(3, 6, 1.6), {0.7, -0.6, 0.5}, 0.7), 1.0 / 12,
                           rays(), {.solvers = true});
}
TEST(FieldsSlow, Warp) {
  json field = testing::eq13_json(1, 7);
  field["modulations"].push_back({{"type", "warp"},
                                  {"noise", "perlin"},
                                  {"amplitude", 0.15},
                                  {"frequency", 2},
                                  {"layers", 1},
                                  {"seed", 8}});
  test::compare_with_march(part(field, {0.7, 0.5, 0.3}, 1.0), 1.0 / 4, rays(), {.solvers = true});
}
TEST(FieldsSlow, Blobs) {
  const json density = {{"type", "metaballs"},
                        {"level", 0.4},
                        {"balls",
                         {{{"center", {-0.8, 0, 0}}, {"radius", 1.4}, {"weight", 1}},
                          {{"center", {0.8, 0, 0}}, {"radius", 1.4}, {"weight", 1}}}}};
  json field = testing::eq13_json(1, 9, 0.2, 2.0);
  field["density"] = density;
  // Far from the balls the density no longer falls, and there is debris everywhere.
  const json bounds = {{"min", {-2.4, -1.6, -1.6}}, {"max", {2.4, 1.6, 1.6}}};
  test::compare_with_march(hypertexture(field, bounds), 0.5, rays(),
                           {.least_components = 1, .solvers = true, .streamline = true});
}

}  // namespace
}  // namespace morsel::geom

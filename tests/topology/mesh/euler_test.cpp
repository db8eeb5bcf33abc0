// SPDX-License-Identifier: Apache-2.0
// Three independent ways to the topology of each piece: the mesh (V - E + F), the octree's cells,
// and the critical points (maxima - 2-saddles + 1-saddles - minima).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "tests/hypertexture_geom/test_fields.h"
#include "tests/topology/mesh/closed_mesh.h"
#include "topology/bound_solid.h"
#include "topology/mesh/mesh.h"
#include "topology/morse/audit.h"

namespace morsel::topology {
namespace {

using testing::certify_in;
using testing::cube;

// Returns the least characteristic of a piece: 2 for a ball, less for one with handles.
void expect_equal_characteristics(const nlohmann::json& json, double error,
                                  std::int64_t* least = nullptr) {
  const auto field = geom::testing::field_of(json);
  const Topology t = certify_in(*field, find_solid(*field, cube(4.0)));
  ASSERT_TRUE(t.certified) << json;
  MorseOptions options;
  options.box = t.box;
  const MorseComplex complex = morse_complex(*field, options);
  const Audit a = audit(*field, t, complex);
  ASSERT_TRUE(a.agreed()) << json;  // octree and critical points
  const Mesh mesh = testing::mesh_of(*field, t, error, "all");
  ASSERT_TRUE(mesh.certified) << json;
  const std::vector<MeshComponent> parts = mesh_components(mesh);
  ASSERT_EQ(parts.size(), t.components.size()) << json;
  for (const MeshComponent& part : parts)
    EXPECT_EQ(part.euler_characteristic, 2 * a.euler[part.component])
        << json << " component " << part.component;
  if (least == nullptr) return;
  for (const MeshComponent& part : parts) *least = std::min(*least, part.euler_characteristic);
}

nlohmann::json rock(const char* noise, double amplitude, double frequency, int seed) {
  return {{"density", {{"type", "sphere"}, {"radius", 1.0}}},
          {"modulations",
           {{{"type", "fbm"},
             {"noise", noise},
             {"amplitude", amplitude},
             {"frequency", frequency},
             {"layers", 1},
             {"seed", seed}}}}};
}

TEST(MeshEuler, IsTheMorseSumOfEachPiece) {
  std::int64_t least = 2;
  expect_equal_characteristics({{"density", {{"type", "torus"}}},
                                {"modulations",
                                 {{{"type", "fbm"},
                                   {"noise", "sparse_convolution"},
                                   {"amplitude", 0.1},
                                   {"frequency", 2.0},
                                   {"layers", 1},
                                   {"seed", 2}}}}},
                               0.05, &least);
  EXPECT_LE(least, 0);  // the torus has its hole
  for (const int seed : {1, 2}) {
    expect_equal_characteristics(rock("sparse_convolution", 0.6, 1.7, seed), 0.05);
    expect_equal_characteristics(rock("perlin", 0.9, 1.7, seed), 0.05);
  }
}

}  // namespace
}  // namespace morsel::topology

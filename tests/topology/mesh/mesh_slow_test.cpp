// SPDX-License-Identifier: Apache-2.0
// The mesh of the paper's rock, and self-intersection by an independent library where it is there.
#include <gtest/gtest.h>

#include <numbers>

#ifdef MORSEL_HAVE_CGAL
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#endif

#include "tests/hypertexture_geom/test_fields.h"
#include "tests/topology/blobs.h"
#include "tests/topology/mesh/closed_mesh.h"
#include "topology/bound_solid.h"
#include "topology/mesh/mesh.h"

namespace morsel::topology {
namespace {

using geom::testing::field_of;
using testing::certify_in;
using testing::cube;
using testing::expect_closed_manifold;
using testing::expect_near_surface;
using testing::mesh_of;

TEST(MeshSlow, RockOfOneLayer) {
  const auto field = field_of(geom::testing::eq13_json(1, 1));
  const Topology t = certify_in(*field, find_solid(*field, cube(4.0)));
  ASSERT_TRUE(t.certified);
  const double error = 5e-3;
  const Mesh mesh = mesh_of(*field, t, error, "main");
  EXPECT_TRUE(mesh.certified);
  EXPECT_EQ(mesh.unresolved_cells, 0u);
  expect_closed_manifold(mesh);
  expect_near_surface(mesh, *field, error, 100000);
  const std::vector<MeshComponent> parts = mesh_components(mesh);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].component, 0u);
  EXPECT_GE(parts[0].volume, t.components[0].volume_lo * 0.98);
  EXPECT_LE(parts[0].volume, t.components[0].volume_hi * 1.02);
  // The same topology whatever the error and wherever the octree's planes lie.
  const MeshComponent finer = mesh_components(mesh_of(*field, t, error / 3.0, "main"))[0];
  EXPECT_EQ(finer.euler_characteristic, parts[0].euler_characteristic);
  EXPECT_EQ(finer.surfaces, parts[0].surfaces);
  Box shifted = find_solid(*field, cube(4.0));
  shifted.min -= Imath::V3d(0.1 * std::numbers::sqrt2, 0.1 * std::numbers::pi / 3.0, 0.0867);
  const MeshComponent moved =
      mesh_components(mesh_of(*field, certify_in(*field, shifted), error, "main"))[0];
  EXPECT_EQ(moved.euler_characteristic, parts[0].euler_characteristic);
  EXPECT_EQ(moved.surfaces, parts[0].surfaces);
}

#ifdef MORSEL_HAVE_CGAL
bool intersects_itself_as_it_is(const Mesh& mesh) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  CGAL::Surface_mesh<Kernel::Point_3> surface;
  for (const Imath::V3d& p : mesh.positions) surface.add_vertex(Kernel::Point_3(p.x, p.y, p.z));
  for (const auto& t : mesh.triangles) {
    const auto vertex = [](std::uint32_t i) {
      return CGAL::Surface_mesh<Kernel::Point_3>::Vertex_index(i);
    };
    EXPECT_TRUE(surface.add_face(vertex(t[0]), vertex(t[1]), vertex(t[2])).is_valid());
  }
  EXPECT_TRUE(CGAL::is_closed(surface));
  return CGAL::Polygon_mesh_processing::does_self_intersect(surface);
}

// Neither as it is nor with the floats that files may hold.
bool intersects_itself(Mesh mesh) {
  if (intersects_itself_as_it_is(mesh)) return true;
  for (Imath::V3d& p : mesh.positions) p = Imath::V3d(Imath::V3f(p));
  return intersects_itself_as_it_is(mesh);
}
#endif

TEST(MeshSlow, DoesNotIntersectItself) {
#ifndef MORSEL_HAVE_CGAL
  GTEST_SKIP() << "needs CGAL: libcgal-dev, which tools/run_tests.sh --slow installs";
#else
  const auto sphere = field_of({{"density", {{"type", "sphere"}, {"radius", 1.0}}}});
  for (const double error : {0.1, 1e-2, 1e-3})
    EXPECT_FALSE(intersects_itself(mesh_of(*sphere, certify_in(*sphere, cube(1.3)), error)));
  // The thinnest of bridges, and surfaces that touch planes of the octree.
  const testing::Blobs bridge({{0.765, 0, 0}, {-0.765, 0, 0}}, 1.0, 0.14);
  EXPECT_FALSE(intersects_itself(mesh_of(bridge, certify_in(bridge, cube(2.4)), 0.02)));
  const testing::Blobs touching({Imath::V3d(0.0)}, 1.0, 0.421875);
  EXPECT_FALSE(intersects_itself(mesh_of(touching, certify_in(touching, cube(1.0)), 1e-3)));
  for (const int seed : {1, 2, 3}) {
    const auto rock = field_of(geom::testing::eq13_json(2, seed, 0.6, 1.5));
    const Topology t = certify_in(*rock, find_solid(*rock, cube(4.0)));
    EXPECT_FALSE(intersects_itself(mesh_of(*rock, t, 0.02))) << seed;
  }
#endif
}

}  // namespace
}  // namespace morsel::topology

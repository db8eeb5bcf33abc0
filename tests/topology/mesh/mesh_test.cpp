// SPDX-License-Identifier: Apache-2.0
// The mesh of what is kept, against closed forms.
#include "topology/mesh/mesh.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <numbers>

#include "tests/hypertexture_geom/test_fields.h"
#include "tests/topology/blobs.h"
#include "tests/topology/mesh/closed_mesh.h"

namespace morsel::topology {
namespace {

using geom::testing::field_of;
using testing::Blobs;
using testing::certify_in;
using testing::cube;
using testing::expect_closed_manifold;
using testing::expect_near_surface;
using testing::mesh_of;
using testing::two_blobs;

TEST(Mesh, SphereAtEveryError) {
  const auto field = field_of({{"density", {{"type", "sphere"}, {"radius", 1.0}}}});
  const Topology t = certify_in(*field, cube(1.3));
  std::size_t previous = 0;
  for (const double error : {0.1, 1e-2, 1e-3, 1e-4}) {
    const Mesh mesh = mesh_of(*field, t, error);
    EXPECT_TRUE(mesh.certified);
    EXPECT_EQ(mesh.unresolved_cells, 0u);
    expect_closed_manifold(mesh);
    expect_near_surface(mesh, *field, error, 2000);
    const std::vector<MeshComponent> parts = mesh_components(mesh);
    ASSERT_EQ(parts.size(), 1u);
    EXPECT_EQ(parts[0].surfaces, 1u);
    EXPECT_EQ(parts[0].euler_characteristic, 2);
    const double radius = std::sqrt(1.0 - 1e-4);
    EXPECT_NEAR(parts[0].volume, 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3),
                4.0 * std::numbers::pi * error);
    EXPECT_GT(mesh.triangles.size(), previous);
    previous = mesh.triangles.size();
  }
  // Equilateral triangles inscribed in the unit sphere are off by R^2 / 2 for a circumscribed
  // radius R; cells that halve can cost up to four times as many.
  const double fewest = 4.0 * std::numbers::pi / (0.75 * std::sqrt(3.0) * 2e-4);
  EXPECT_LT(static_cast<double>(previous), 4.0 * fewest);
}

TEST(Mesh, TorusHasGenusOne) {
  const auto field =
      field_of({{"density", {{"type", "torus"}, {"major_radius", 1.0}, {"minor_radius", 0.3}}}});
  const Mesh mesh = mesh_of(*field, certify_in(*field, cube(1.6)), 1e-3);
  EXPECT_TRUE(mesh.certified);
  expect_closed_manifold(mesh);
  expect_near_surface(mesh, *field, 1e-3, 10000);
  const std::vector<MeshComponent> parts = mesh_components(mesh);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].surfaces, 1u);
  EXPECT_EQ(parts[0].euler_characteristic, 0);
}

TEST(Mesh, GapsAndBridgesFarBelowTheError) {
  for (const Imath::V3d& direction : {Imath::V3d(1, 0, 0), Imath::V3d(0.3, 0.5, 0.8)}) {
    for (const Imath::V3d& shift : {Imath::V3d(0.0), Imath::V3d(0.1234, -0.0567, 0.0891)}) {
      for (int digits = 1; digits <= 6; ++digits) {
        const double size = std::pow(10.0, -digits);
        for (const bool joined : {false, true}) {
          SCOPED_TRACE(::testing::Message() << digits << (joined ? " bridge" : " gap"));
          const Blobs field = two_blobs(joined ? size : -size, direction, shift);
          const Mesh mesh = mesh_of(field, certify_in(field, cube(2.4)), 0.01);
          EXPECT_TRUE(mesh.certified);
          EXPECT_EQ(mesh.unresolved_cells, 0u);
          expect_closed_manifold(mesh);
          expect_near_surface(mesh, field, 0.01, 2000);
          const std::vector<MeshComponent> parts = mesh_components(mesh);
          ASSERT_EQ(parts.size(), joined ? 1u : 2u);
          for (const MeshComponent& part : parts) {
            EXPECT_EQ(part.surfaces, 1u);
            EXPECT_EQ(part.euler_characteristic, 2);
            EXPECT_GT(part.volume, 0.5);
          }
        }
      }
    }
  }
}

TEST(Mesh, TouchingBlobsAreReportedWithThePlace) {
  const Imath::V3d middle(0.01, 0.02, 0.03);
  const Blobs field = two_blobs(0.0, {0.3, 0.5, 0.8}, middle);
  const Mesh mesh = mesh_of(field, certify_in(field, cube(2.4)), 0.01);
  EXPECT_FALSE(mesh.certified);
  ASSERT_GT(mesh.unresolved_cells, 0u);
  EXPECT_LT((centre(mesh.unresolved[0].box) - middle).length(), 1e-3);
  expect_closed_manifold(mesh);
}

TEST(Mesh, ChainsRingsAndCavities) {
  std::vector<Imath::V3d> chain, ring, shell;
  for (int i = 0; i < 5; ++i) chain.emplace_back(1.0 * i, 0.1 * i, 0.0);
  const int count = 10;
  for (int i = 0; i < count; ++i) {
    const double a = 2.0 * std::numbers::pi * i / count;
    ring.emplace_back(1.5 * std::cos(a), 1.5 * std::sin(a), 0.2);
  }
  // A spiral over a sphere: blobs that overlap all around a hollow.
  for (int i = 0; i < 200; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / 200.0, r = std::sqrt(1.0 - z * z), a = 2.399963 * i;
    shell.push_back(Imath::V3d(r * std::cos(a), r * std::sin(a), z) * 2.0);
  }
  const struct {
    std::vector<Imath::V3d> centres;
    std::uint64_t surfaces;
    std::int64_t euler;
  } cases[] = {{chain, 1, 2}, {ring, 1, 0}, {shell, 2, 4}};
  for (const auto& c : cases) {
    const Blobs field(c.centres, 1.0, 0.3);
    const Mesh mesh = mesh_of(field, certify_in(field, cube(7.0)), 0.03);
    EXPECT_TRUE(mesh.certified);
    expect_closed_manifold(mesh);
    expect_near_surface(mesh, field, 0.03, 2000);
    const std::vector<MeshComponent> parts = mesh_components(mesh);
    ASSERT_EQ(parts.size(), 1u);
    EXPECT_EQ(parts[0].surfaces, c.surfaces);
    EXPECT_EQ(parts[0].euler_characteristic, c.euler);
  }
}

// A solid cut out of a plane grid's planes: flat where the octree's planes are.
TEST(Mesh, SurfacesThatTouchThePlanesOfTheOctree) {
  // Two blobs of which one has its level set pass through grid points, and a box with flat sides on
  // planes of the octree.
  const auto box = field_of(
      {{"density", {{"type", "rounded_box"}, {"half_size", {0.5, 0.5, 0.25}}, {"rounding", 0.1}}}});
  const auto sphere = field_of({{"density", {{"type", "sphere"}, {"radius", 0.5}}}});
  const Blobs through_corners({Imath::V3d(0.0)}, 1.0, std::pow(1.0 - 0.25, 3));
  for (const ScalarField* field :
       {static_cast<const ScalarField*>(box.get()), static_cast<const ScalarField*>(sphere.get()),
        static_cast<const ScalarField*>(&through_corners)}) {
    const Mesh mesh = mesh_of(*field, certify_in(*field, cube(1.0)), 1e-3);
    EXPECT_TRUE(mesh.certified);
    expect_closed_manifold(mesh);
    expect_near_surface(mesh, *field, 1e-3, 2000);
    const std::vector<MeshComponent> parts = mesh_components(mesh);
    ASSERT_EQ(parts.size(), 1u);
    EXPECT_EQ(parts[0].surfaces, 1u);
    EXPECT_EQ(parts[0].euler_characteristic, 2);
  }
}

// Where it is flat there are few triangles: the upper and lower side of a lens, whose curvature is
// a 125th of its rim's, against the rim.
TEST(Mesh, FlatPartsAreCoarse) {
  const auto lens = field_of({{"density", {{"type", "ellipsoid"}, {"radii", {1.0, 1.0, 0.2}}}}});
  const Mesh mesh = mesh_of(*lens, certify_in(*lens, cube(1.3)), 5e-4);
  expect_closed_manifold(mesh);
  double flat_area = 0.0, area = 0.0;
  std::size_t flat = 0;
  for (const auto& t : mesh.triangles) {
    const Imath::V3d a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    const Imath::V3d x = (a + b + c) / 3.0;
    const double size = 0.5 * (b - a).cross(c - a).length();
    area += size;
    if (x.x * x.x + x.y * x.y > 0.7) continue;
    flat_area += size;
    ++flat;
  }
  EXPECT_GT(flat_area, 0.6 * area);
  EXPECT_LT(static_cast<double>(flat), 0.4 * static_cast<double>(mesh.triangles.size()));
}

TEST(Mesh, ASolidCutByItsBoxIsRefused) {
  const auto sphere = field_of({{"density", {{"type", "sphere"}, {"radius", 1.0}}}});
  const Topology t = certify_in(*sphere, {{-1.5, -1.5, -1.5}, {1.5, 1.5, 0.5}});
  try {
    mesh_of(*sphere, t, 1e-2);
    FAIL() << "not refused";
  } catch (const MeshOpen& e) {
    EXPECT_NEAR(e.place.z, 0.5, 1e-2);
    EXPECT_NE(std::string(e.what()).find("bounds"), std::string::npos);
  }
}

// Also where no surface meets the box's boundary: all of that is solid.
TEST(Mesh, ASolidThatFillsItsBoxIsRefused) {
  const auto ball = field_of({{"density", {{"type", "sphere"}, {"radius", 1.0}}}});
  EXPECT_THROW(mesh_of(*ball, certify_in(*ball, cube(0.3)), 0.1), MeshOpen);
  // A hollow within: its surface is closed, the solid's isn't.
  const auto hollow = field_of(
      {{"density",
        {{"type", "difference"},
         {"densities",
          {{{"type", "sphere"}, {"radius", 3.0}}, {{"type", "sphere"}, {"radius", 0.3}}}}}}});
  const Topology t = certify_in(*hollow, cube(1.0));
  ASSERT_EQ(t.components.size(), 1u);
  EXPECT_THROW(mesh_of(*hollow, t, 0.05), MeshOpen);
}

TEST(Mesh, WhatIsNotKeptIsNotThere) {
  const Blobs field({{-2, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 4, 0}}, 1.0, 0.3);
  const Topology t = certify_in(field, cube(6.0));
  ASSERT_EQ(t.components.size(), 3u);
  const auto sizes = [&](const char* keep) {
    std::vector<std::uint32_t> ids;
    for (const MeshComponent& c : mesh_components(mesh_of(field, t, 0.01, keep)))
      ids.push_back(c.component);
    return ids;
  };
  EXPECT_EQ(sizes("main"), (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(sizes("detached"), (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(sizes("all"), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(sizes("volume:1000"), (std::vector<std::uint32_t>{}));
  // All of it is the parts side by side.
  EXPECT_EQ(mesh_of(field, t, 0.01, "all").triangles.size(),
            mesh_of(field, t, 0.01, "main").triangles.size() +
                mesh_of(field, t, 0.01, "detached").triangles.size());
}

TEST(Mesh, DoesNotDependOnThreads) {
  const auto field = field_of(geom::testing::eq13_json(1, 3, 0.6, 1.5));
  const Topology t = certify_in(*field, cube(2.5));
  std::vector<Mesh> meshes(2);
  for (const int threads : {1, 2}) {
    tbb::task_arena arena(threads);
    arena.execute(
        [&] { meshes[static_cast<std::size_t>(threads - 1)] = mesh_of(*field, t, 0.02); });
  }
  EXPECT_EQ(meshes[0].positions, meshes[1].positions);
  EXPECT_EQ(meshes[0].normals, meshes[1].normals);
  EXPECT_EQ(meshes[0].triangles, meshes[1].triangles);
}

TEST(Mesh, ALumpWithItsDebris) {
  const auto field = field_of(geom::testing::eq13_json(1, 3, 0.6, 1.5));
  const Topology t = certify_in(*field, cube(2.5));
  ASSERT_GT(t.components.size(), 1u);
  const Mesh mesh = mesh_of(*field, t, 0.03, "main");
  EXPECT_TRUE(mesh.certified);
  EXPECT_EQ(mesh.unresolved_cells, 0u);
  expect_closed_manifold(mesh);
  expect_near_surface(mesh, *field, 0.03, 5000);
  const std::vector<MeshComponent> parts = mesh_components(mesh);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].component, 0u);
  // The same topology whatever the error.
  const MeshComponent finer = mesh_components(mesh_of(*field, t, 0.015, "main"))[0];
  EXPECT_EQ(finer.euler_characteristic, parts[0].euler_characteristic);
  EXPECT_EQ(finer.surfaces, parts[0].surfaces);
}

TEST(Mesh, WrongArgumentsAndCancelling) {
  const auto field = field_of({{"density", {{"type", "sphere"}, {"radius", 1.0}}}});
  const Topology t = certify_in(*field, cube(1.3));
  EXPECT_THROW(mesh_of(*field, t, 0.0), std::invalid_argument);
  EXPECT_THROW(mesh_of(*field, t, -1.0), std::invalid_argument);
  EXPECT_THROW(mesh_of(*field, t, std::nan("")), std::invalid_argument);
  EXPECT_THROW(mesh_of(*field, t, 0.1, "all", kMaxDepth + 1), std::invalid_argument);
  const std::atomic<bool> cancel{true};
  Execution execution;
  execution.cancel = &cancel;
  MeshOptions options;
  options.error = 1e-3;
  EXPECT_THROW(extract_mesh(*field, t.octree(), {true}, options, execution), Cancelled);
}

// Both of the labelled cells that it starts from and of those that it makes.
TEST(Mesh, StopsBeforeItTakesMoreMemoryThanAllowed) {
  const auto field = field_of({{"density", {{"type", "sphere"}, {"radius", 1.0}}}});
  const Topology t = certify_in(*field, cube(1.3));
  MeshOptions options;
  options.error = 1e-4;
  const std::uint64_t cells = extract_mesh(*field, t.octree(), {true}, options).cells;
  Execution execution;
  for (const std::uint64_t bytes : {std::uint64_t{1}, 100 * cells, 599 * cells}) {
    execution.max_bytes = bytes;
    EXPECT_THROW(extract_mesh(*field, t.octree(), {true}, options, execution), MemoryLimit);
  }
  execution.max_bytes = 601 * cells;
  EXPECT_EQ(extract_mesh(*field, t.octree(), {true}, options, execution).cells, cells);
}

TEST(Mesh, ADepthLimitThatIsTooShallowIsReported) {
  const auto field = field_of({{"density", {{"type", "sphere"}, {"radius", 1.0}}}});
  const Mesh mesh = mesh_of(*field, certify_in(*field, cube(1.3)), 1e-4, "all", 5);
  EXPECT_EQ(mesh.depth, 5);
  EXPECT_GT(mesh.error_bound, 1e-4);
  EXPECT_GT(mesh.unresolved_cells, 0u);
  EXPECT_TRUE(mesh.certified);  // of the topology, that is
  expect_closed_manifold(mesh);
}

}  // namespace
}  // namespace morsel::topology

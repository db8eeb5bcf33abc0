// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <vector>

#include "topology/certified.h"
#include "topology/octree.h"
#include "topology/scalar_field.h"

namespace morsel::topology {

// What to mesh.
struct MeshOptions {
  // Largest distance of a point of the mesh from the surface F = 0, an object-space length > 0.
  double error = 0.0;
  // Cells are not subdivided below this level of the octree.
  int max_depth = kMaxDepth;
};

// A closed triangle mesh: each edge belongs to exactly two triangles, which traverse it in opposite
// directions; the solid lies behind every closed surface whose triangles look counter-clockwise. A
// triangle that is narrower than the error may be tilted by any angle, also beyond its vertices'
// normals.
struct Mesh {
  std::vector<Imath::V3d> positions;
  std::vector<Imath::V3f> normals;        // unit, outward: -grad F, from the exact gradient
  std::vector<std::uint32_t> components;  // of each vertex: index in the table of components
  std::vector<std::array<std::uint32_t, 3>> triangles;

  // Proved: no point of the mesh is farther from F = 0 than this. Above MeshOptions::error, or
  // infinite, only in `unresolved` cells: at the depth limit, or where rounding leaves no level
  // between the surface and a saddle.
  double error_bound = 0.0;
  // Proved: the solids bounded by mesh and surface are homotopy equivalent in every cell, so that
  // they have the same components, tunnels and cavities. Otherwise `unresolved` says where not.
  bool certified = false;
  std::uint64_t unresolved_cells = 0;  // whose topology is not proved, or whose error is too large
  std::vector<Unresolved> unresolved;  // the first 1000 of them
  std::uint64_t cells = 0;             // that hold surface
  int depth = 0;                       // level of the smallest of them
};

// The surface of the components with kept[id], within the octree's box. `octree` was labelled for
// `field`; cells that hold nothing kept are not looked at. Runs in the caller's TBB arena; the
// result does not depend on the number of threads. Throws std::invalid_argument unless the error is
// positive and above what rounding alone takes up, MeshOpen when the box cuts a kept component,
// MemoryLimit, Cancelled.
Mesh extract_mesh(const ScalarField& field, const OctreeView& octree, const std::vector<bool>& kept,
                  const MeshOptions& options, const Execution& execution = {});

// The kept solid reaches the boundary of the box, where its surface would end.
struct MeshOpen : std::runtime_error {
  explicit MeshOpen(const Imath::V3d& place);
  Imath::V3d place;
};

// What a mesh says of one component.
struct MeshComponent {
  std::uint32_t component = 0;
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  std::uint64_t surfaces = 0;  // connected closed surfaces: 1 + the number of cavities
  // Of its surface (V - E + F, summed over the closed surfaces); half of it is the Euler
  // characteristic of the solid.
  std::int64_t euler_characteristic = 0;
  double area = 0.0;
  double volume = 0.0;  // enclosed, cavities subtracted
};

// One entry for each component that has triangles, by increasing id.
std::vector<MeshComponent> mesh_components(const Mesh& mesh);

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "hypertexture_geom/embree/geometry.h"
#include "hypertexture_geom/field/field.h"
#include "renderer/accel/embree_handles.h"
#include "topology/mesh/mesh.h"

namespace morsel::tools {

// One surface in an Embree scene of its own, and what making it took. Seconds are processor time.
struct BenchSurface {
  std::unique_ptr<render::Device> device;
  std::unique_ptr<geom::HypertextureGeometry> hypertexture;  // null for a mesh
  render::SceneHandle scene;
  double geometry_seconds = 0.0;     // bricks; 0 for a mesh, see extract_mesh
  double bvh_seconds = 0.0;          // Embree's
  std::uint64_t geometry_bytes = 0;  // bricks with their fields; vertices and indices
  std::uint64_t bvh_bytes = 0;       // all else that Embree allocated

  std::uint64_t bytes() const { return geometry_bytes + bvh_bytes; }
};

BenchSurface trace_hypertexture(std::shared_ptr<const geom::Field> field,
                                std::shared_ptr<const topology::TopologyCache> cache,
                                const geom::GeometryOptions& options);

// The box of the cells of the kept components; empty when nothing is kept.
topology::Box kept_bounds(const topology::Topology& topology, const std::vector<bool>& kept);

// The mesh of what is kept, no farther than `error` of the diagonal of kept_bounds() from the
// surface. Throws std::runtime_error that names the geometry when nothing is kept.
topology::Mesh mesh_kept(const geom::Hypertexture& hypertexture, const topology::Topology& topology,
                         double error, const topology::Execution& execution);

// The triangles with float positions and 32-bit indices, built as the renderer builds meshes:
// robust, high quality. Vertex normals are not counted: tracing needs none.
BenchSurface trace_mesh(const topology::Mesh& mesh);

}  // namespace morsel::tools

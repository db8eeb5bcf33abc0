// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "renderer/accel/embree_handles.h"
#include "renderer/accel/interaction.h"
#include "renderer/accel/transform.h"
#include "renderer/math/huge_pages.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// A committed Embree geometry with copies of the mesh's positions and triangles. Throws
// std::invalid_argument naming `name` for vertex numbers or array sizes that don't fit.
GeometryHandle create_mesh_geometry(const Device& device, const TriangleMesh& mesh,
                                    const std::string& name);

// What hits of a mesh are made of: what each vertex has lies together, so that a hit fetches three
// pieces of memory and not nine.
class ShadedMesh {
 public:
  // `mesh`, which create_mesh_geometry() has checked, must outlive this object.
  explicit ShadedMesh(const TriangleMesh& mesh);

  // Writes all of the interaction for the hit at barycentric (u, v) of a triangle but for t, time
  // and the numbers of instance, geometry, primitive and material. It refers to `transform`.
  void interact(const InstanceTransform& transform, std::uint32_t triangle, float u, float v,
                SurfaceInteraction& interaction) const;

 private:
  void interpolate_more(const Imath::V3i& triangle, float b0, float b1, float b2,
                        SurfaceInteraction& interaction) const;

  const TriangleMesh& mesh_;
  const Imath::V3i* triangles_;
  bool has_normals_, has_uvs_;
  bool has_more_;  // a second set of coordinates, colours or alphas
  std::vector<MeshVertex, HugePageAllocator<MeshVertex>> vertices_;
};

}  // namespace morsel::render

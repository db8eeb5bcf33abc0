// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "renderer/mesh/gltf_file.h"
#include "renderer/mesh/readers.h"

namespace morsel::render {
namespace {

constexpr std::size_t kMaxVertices = 0x7fffffffu;

// All triangles of a file as one mesh.
class Flattener {
 public:
  explicit Flattener(const tinygltf::Model& model) : model_(model) {}

  TriangleMesh flatten() {
    if (model_.scenes.empty()) {
      for (std::size_t i = 0; i < model_.meshes.size(); ++i) add_mesh(i, Imath::M44d());
    } else {
      for_each_node(model_, [&](const tinygltf::Node& node, int, const Imath::M44d& transform) {
        if (node.mesh >= 0) add_mesh(static_cast<std::size_t>(node.mesh), transform);
      });
    }
    if (!any_normals_) mesh_.normals.clear();
    if (!any_uvs_) mesh_.uvs.clear();
    return std::move(mesh_);
  }

 private:
  void add_mesh(std::size_t mesh, const Imath::M44d& transform) {
    for (std::size_t i = 0; i < model_.meshes[mesh].primitives.size(); ++i)
      if (const auto part = read_primitive(model_, mesh, i)) add(*part, transform);
  }

  void add(const TriangleMesh& part, const Imath::M44d& transform) {
    const std::size_t first = mesh_.positions.size(), count = part.positions.size();
    if (first + count > kMaxVertices) throw GltfError("more than 2^31 vertices");
    for (const Imath::V3f& p : part.positions) {
      Imath::V3d moved;
      transform.multVecMatrix(Imath::V3d(p), moved);
      mesh_.positions.emplace_back(moved);
    }
    add_normals(part, transform);
    any_uvs_ = any_uvs_ || !part.uvs.empty();
    mesh_.uvs.insert(mesh_.uvs.end(), part.uvs.begin(), part.uvs.end());
    mesh_.uvs.resize(mesh_.positions.size(), Imath::V2f(0.0f, 1.0f));
    // A mirroring transform turns the winding round; turn it back.
    const bool mirrored = transform.determinant() < 0;
    for (Imath::V3i triangle : part.triangles) {
      triangle += Imath::V3i(static_cast<int>(first));
      if (mirrored) std::swap(triangle[1], triangle[2]);
      mesh_.triangles.push_back(triangle);
    }
  }

  // By the transposed inverse. Unit length or zero (absent): load_mesh makes zero ones smooth.
  void add_normals(const TriangleMesh& part, const Imath::M44d& transform) {
    any_normals_ = any_normals_ || !part.normals.empty();
    const Imath::M44d inverse = transform.inverse().transposed();
    for (const Imath::V3f& n : part.normals) {
      Imath::V3d turned;
      inverse.multDirMatrix(Imath::V3d(n), turned);
      mesh_.normals.emplace_back(turned.normalized());
    }
    mesh_.normals.resize(mesh_.positions.size(), Imath::V3f(0.0f));
  }

  const tinygltf::Model& model_;
  TriangleMesh mesh_;
  bool any_normals_ = false;
  bool any_uvs_ = false;
};

}  // namespace

TriangleMesh read_gltf(const std::filesystem::path& file) {
  try {
    return Flattener(parse_gltf(file)).flatten();
  } catch (const std::exception& e) {  // GltfError, or bad_alloc for absurd sizes
    throw MeshError(fmt::format("{}: {}", file.string(), e.what()));
  }
}

}  // namespace morsel::render

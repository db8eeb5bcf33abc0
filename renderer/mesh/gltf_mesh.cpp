// SPDX-License-Identifier: Apache-2.0
#include <Imath/ImathMatrix.h>
#include <Imath/ImathQuat.h>
#include <fmt/format.h>

#include <array>
#include <fstream>
#include <optional>

#include "renderer/mesh/gltf_accessor.h"
#include "renderer/mesh/readers.h"

namespace morsel::render {
namespace {

constexpr std::uint32_t kMaxVertices = 0x7fffffffu;

bool no_image(tinygltf::Image*, const int, std::string*, std::string*, int, int,
              const unsigned char*, int, void*) {
  return true;  // geometry only: a missing or broken texture is no obstacle
}

tinygltf::Model parse(const std::filesystem::path& file) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(no_image, nullptr);
  tinygltf::Model model;
  std::string error, warning;
  std::string start(4, '\0');
  std::ifstream(file, std::ios::binary).read(start.data(), 4);
  const bool done = start == "glTF"
                        ? loader.LoadBinaryFromFile(&model, &error, &warning, file.string())
                        : loader.LoadASCIIFromFile(&model, &error, &warning, file.string());
  if (done) {
    if (model.asset.version.rfind("2.", 0) != 0)
      throw GltfError(
          fmt::format("is of glTF version \"{}\"; only 2 is supported", model.asset.version));
    return model;
  }
  while (!error.empty() && error.back() == '\n') error.pop_back();
  throw GltfError(error.empty() ? "not a glTF file" : error);
}

// An extension that the file says cannot be ignored, and that changes what the geometry is.
void refuse_unknown_extensions(const tinygltf::Model& model) {
  for (const std::string& name : model.extensionsRequired) {
    const bool harmless = name.rfind("KHR_materials_", 0) == 0 ||
                          name.rfind("KHR_texture_", 0) == 0 || name == "KHR_lights_punctual" ||
                          name == "EXT_texture_webp";
    if (!harmless) throw GltfError("requires the extension " + name + ", which is not supported");
  }
}

// Row vectors, as Imath has it; a column-major matrix for column vectors has the same layout.
Imath::M44d local_transform(const tinygltf::Node& node) {
  Imath::M44d m;
  if (node.matrix.size() == 16) {
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
    return m;
  }
  if (node.scale.size() == 3) m.setScale(Imath::V3d(node.scale[0], node.scale[1], node.scale[2]));
  if (node.rotation.size() == 4) {
    Imath::Quatd q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    m *= q.normalize().toMatrix44();
  }
  if (node.translation.size() == 3)
    for (int i = 0; i < 3; ++i) m[3][i] = node.translation[static_cast<std::size_t>(i)];
  return m;
}

// Corners of the triangles of one primitive, by glTF's rules for lists, strips and fans.
std::vector<std::array<std::uint32_t, 3>> triangles_of(const std::vector<std::uint32_t>& index,
                                                       int mode) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const std::size_t n = index.size();
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    for (std::size_t i = 0; i + 2 < n; i += 3)
      triangles.push_back({index[i], index[i + 1], index[i + 2]});
  } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
    for (std::size_t i = 0; i + 2 < n; ++i) {
      const std::size_t odd = i % 2;  // every other triangle is wound the other way
      triangles.push_back({index[i], index[i + 1 + odd], index[i + 2 - odd]});
    }
  } else if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
    for (std::size_t i = 1; i + 1 < n; ++i) triangles.push_back({index[i], index[i + 1], index[0]});
  }
  return triangles;
}

class Flattener {
 public:
  explicit Flattener(const tinygltf::Model& model)
      : model_(model), visited_(model.nodes.size(), false) {}

  TriangleMesh flatten() {
    if (model_.scenes.empty()) {
      for (const tinygltf::Mesh& mesh : model_.meshes) add_mesh(mesh, Imath::M44d());
    } else {
      const std::size_t scene =
          model_.defaultScene < 0 ? 0 : static_cast<std::size_t>(model_.defaultScene);
      if (scene >= model_.scenes.size())
        throw GltfError(fmt::format("scene {} does not exist", scene));
      for (const int root : model_.scenes[scene].nodes) add_nodes(root);
    }
    if (!any_normals_) mesh_.normals.clear();
    if (!any_uvs_) mesh_.uvs.clear();
    return std::move(mesh_);
  }

 private:
  // An explicit stack: a hostile file can nest nodes deeper than the call stack goes.
  void add_nodes(int root) {
    std::vector<std::pair<int, Imath::M44d>> stack{{root, Imath::M44d()}};
    while (!stack.empty()) {
      const auto [index, parent] = stack.back();
      stack.pop_back();
      if (index < 0 || static_cast<std::size_t>(index) >= model_.nodes.size())
        throw GltfError(fmt::format("node {} does not exist", index));
      if (visited_[static_cast<std::size_t>(index)])
        throw GltfError(fmt::format("node {} is reached twice; nodes must form a tree", index));
      visited_[static_cast<std::size_t>(index)] = true;
      const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
      const Imath::M44d transform = local_transform(node) * parent;
      if (node.mesh >= 0) {
        if (static_cast<std::size_t>(node.mesh) >= model_.meshes.size())
          throw GltfError(
              fmt::format("node {} names mesh {}, which does not exist", index, node.mesh));
        add_mesh(model_.meshes[static_cast<std::size_t>(node.mesh)], transform);
      }
      for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
        stack.emplace_back(*child, transform);
    }
  }

  void add_mesh(const tinygltf::Mesh& mesh, const Imath::M44d& transform) {
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
      if (mode != TINYGLTF_MODE_TRIANGLES && mode != TINYGLTF_MODE_TRIANGLE_STRIP &&
          mode != TINYGLTF_MODE_TRIANGLE_FAN)
        continue;  // points and lines
      add_primitive(primitive, mode, transform);
    }
  }

  static std::optional<int> attribute(const tinygltf::Primitive& primitive, const char* name) {
    const auto it = primitive.attributes.find(name);
    if (it == primitive.attributes.end()) return std::nullopt;
    return it->second;
  }

  void add_primitive(const tinygltf::Primitive& primitive, int mode, const Imath::M44d& transform) {
    const std::optional<int> position = attribute(primitive, "POSITION");
    if (!position) return;  // the specification: such a primitive is skipped
    const std::vector<Imath::V3f> positions = read_vectors3(model_, *position);
    std::vector<Imath::V3f> normals(positions.size(), Imath::V3f(0.0f));
    std::vector<Imath::V2f> uvs(positions.size(), Imath::V2f(0.0f));
    if (const std::optional<int> normal = attribute(primitive, "NORMAL")) {
      normals = read_vectors3(model_, *normal);
      any_normals_ = true;
    }
    if (const std::optional<int> uv = attribute(primitive, "TEXCOORD_0")) {
      uvs = read_vectors2(model_, *uv);
      for (Imath::V2f& coordinates : uvs) coordinates.y = 1.0f - coordinates.y;  // glTF's v is down
      any_uvs_ = true;
    }
    if (normals.size() != positions.size() || uvs.size() != positions.size())
      throw GltfError("a primitive has attributes of different lengths");

    std::vector<std::uint32_t> indices;
    if (primitive.indices >= 0) {
      indices = read_indices(model_, primitive.indices);
    } else {
      for (std::size_t i = 0; i < positions.size(); ++i)
        indices.push_back(static_cast<std::uint32_t>(i));
    }

    const std::size_t first = mesh_.positions.size();
    if (first + positions.size() > kMaxVertices) throw GltfError("more than 2^31 vertices");
    for (const Imath::V3f& p : positions) {
      Imath::V3d moved;
      transform.multVecMatrix(Imath::V3d(p), moved);
      mesh_.positions.emplace_back(moved);
    }
    add_normals(normals, transform);
    mesh_.uvs.insert(mesh_.uvs.end(), uvs.begin(), uvs.end());
    // A mirroring transform turns the winding round; turn it back.
    const bool mirrored = transform.determinant() < 0;
    for (const auto& corners : triangles_of(indices, mode)) {
      for (const std::uint32_t corner : corners)
        if (corner >= positions.size())
          throw GltfError(
              fmt::format("an index is {}, but there are {} vertices", corner, positions.size()));
      Imath::V3i triangle;
      for (int i = 0; i < 3; ++i)
        triangle[i] = static_cast<int>(first + corners[static_cast<std::size_t>(i)]);
      if (mirrored) std::swap(triangle[1], triangle[2]);
      mesh_.triangles.push_back(triangle);
    }
  }

  // By the transposed inverse. Unit length or zero (absent): load_mesh makes zero ones smooth.
  void add_normals(const std::vector<Imath::V3f>& normals, const Imath::M44d& transform) {
    const Imath::M44d inverse = transform.inverse().transposed();
    for (const Imath::V3f& n : normals) {
      Imath::V3d turned;
      inverse.multDirMatrix(Imath::V3d(n), turned);
      mesh_.normals.emplace_back(turned.normalized());
    }
  }

  const tinygltf::Model& model_;
  std::vector<bool> visited_;
  TriangleMesh mesh_;
  bool any_normals_ = false;
  bool any_uvs_ = false;
};

}  // namespace

TriangleMesh read_gltf(const std::filesystem::path& file) {
  try {
    const tinygltf::Model model = parse(file);
    refuse_unknown_extensions(model);
    return Flattener(model).flatten();
  } catch (const std::exception& e) {  // GltfError, or bad_alloc for absurd sizes
    throw MeshError(fmt::format("{}: {}", file.string(), e.what()));
  }
}

}  // namespace morsel::render

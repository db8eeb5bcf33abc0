// SPDX-License-Identifier: Apache-2.0
#include "renderer/mesh/gltf_file.h"

#include <Imath/ImathQuat.h>
#include <fmt/format.h>

#include <array>
#include <fstream>
#include <sstream>

#include "renderer/mesh/gltf_schema.h"

namespace morsel::render {
namespace {

// Decoding is for those who want the pixels.
bool keep_encoded(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void*) {
  image->image.assign(bytes, bytes + size);
  return true;
}

// An extension that the file says cannot be ignored, and that changes what the geometry is.
void refuse_unknown_extensions(const tinygltf::Model& model) {
  for (const std::string& name : model.extensionsRequired) {
    const bool harmless = name.rfind("KHR_materials_", 0) == 0 || name == "KHR_texture_transform" ||
                          name == "KHR_lights_punctual" || name == "KHR_mesh_quantization" ||
                          name == "EXT_texture_webp";
    if (!harmless) throw GltfError("requires the extension " + name + ", which is not supported");
  }
}

// The JSON of a .gltf or .glb.
std::string json_of(const std::filesystem::path& file, bool binary) {
  std::ifstream in(file, std::ios::binary);
  std::string text;
  if (!binary) {
    std::ostringstream all;
    all << in.rdbuf();
    return std::move(all).str();
  }
  unsigned char length[4] = {};
  in.seekg(12);
  in.read(reinterpret_cast<char*>(length), 4);
  in.seekg(20);
  const std::uint64_t bytes =
      length[0] | length[1] << 8 | length[2] << 16 | static_cast<std::uint64_t>(length[3]) << 24;
  if (!in || bytes > std::filesystem::file_size(file)) return text;  // the parser will say so
  text.resize(bytes);
  in.read(text.data(), static_cast<std::streamsize>(bytes));
  return text;
}

// Brackets within brackets: tinygltf calls itself for each level, and the stack ends somewhere.
constexpr int kDeepest = 256;
void refuse_deep_nesting(const std::string& json) {
  int depth = 0;
  bool text = false, escaped = false;
  for (const char c : json) {
    if (text) {
      if (!escaped && c == '"') text = false;
      escaped = !escaped && c == '\\';
    } else if (c == '"') {
      text = true;
    } else if (c == '{' || c == '[') {
      if (++depth > kDeepest)
        throw GltfError(fmt::format("its JSON is nested deeper than {} levels", kDeepest));
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
}

// Row vectors, as Imath has it; a column-major matrix for column vectors has the same layout.
Imath::M44d local_transform(const tinygltf::Node& node, int index) {
  Imath::M44d m;
  if (node.matrix.size() == 16) {
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
    if (m[0][3] != 0.0 || m[1][3] != 0.0 || m[2][3] != 0.0 || m[3][3] != 1.0)
      throw GltfError(fmt::format("node {} has a matrix whose last row is not 0, 0, 0, 1", index));
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

std::optional<int> attribute(const tinygltf::Primitive& primitive, const char* name) {
  const auto it = primitive.attributes.find(name);
  if (it == primitive.attributes.end()) return std::nullopt;
  return it->second;
}

}  // namespace

tinygltf::Model parse_gltf(const std::filesystem::path& file) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_encoded, nullptr);
  tinygltf::Model model;
  std::string error, warning;
  std::string start(4, '\0');
  std::ifstream(file, std::ios::binary).read(start.data(), 4);
  const bool binary = start == "glTF";
  const std::string json = json_of(file, binary);
  refuse_deep_nesting(json);
  check_gltf_types(json);
  const bool done = binary ? loader.LoadBinaryFromFile(&model, &error, &warning, file.string())
                           : loader.LoadASCIIFromFile(&model, &error, &warning, file.string());
  if (done) {
    if (model.asset.version.rfind("2.", 0) != 0)
      throw GltfError(
          fmt::format("is of glTF version \"{}\"; only 2 is supported", model.asset.version));
    refuse_unknown_extensions(model);
    return model;
  }
  while (!error.empty() && error.back() == '\n') error.pop_back();
  throw GltfError(error.empty() ? "not a glTF file" : error);
}

// An explicit stack: a hostile file can nest nodes deeper than the call stack goes.
void for_each_node(
    const tinygltf::Model& model,
    const std::function<void(const tinygltf::Node&, int, const Imath::M44d&)>& visit) {
  if (model.scenes.empty()) return;
  const std::size_t scene =
      model.defaultScene < 0 ? 0 : static_cast<std::size_t>(model.defaultScene);
  if (scene >= model.scenes.size()) throw GltfError(fmt::format("scene {} does not exist", scene));
  std::vector<bool> visited(model.nodes.size(), false);
  std::vector<std::pair<int, Imath::M44d>> stack;
  const auto& roots = model.scenes[scene].nodes;
  for (auto root = roots.rbegin(); root != roots.rend(); ++root)
    stack.emplace_back(*root, Imath::M44d());
  while (!stack.empty()) {
    const auto [index, parent] = stack.back();
    stack.pop_back();
    if (index < 0 || static_cast<std::size_t>(index) >= model.nodes.size())
      throw GltfError(
          fmt::format("node {} does not exist; there are {}", index, model.nodes.size()));
    if (visited[static_cast<std::size_t>(index)])
      throw GltfError(fmt::format("node {} is reached twice; nodes must form a tree", index));
    visited[static_cast<std::size_t>(index)] = true;
    const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(index)];
    const Imath::M44d transform = local_transform(node, index) * parent;
    if (node.mesh >= 0 && static_cast<std::size_t>(node.mesh) >= model.meshes.size())
      throw GltfError(fmt::format("node {} names mesh {}, which does not exist", index, node.mesh));
    visit(node, index, transform);
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
      stack.emplace_back(*child, transform);
  }
}

namespace {

// Texture coordinates of a set, v up; empty if there is none.
std::vector<Imath::V2f> texture_coordinates(const tinygltf::Model& model,
                                            const tinygltf::Primitive& primitive,
                                            const char* name) {
  const std::optional<int> accessor = attribute(primitive, name);
  if (!accessor) return {};
  std::vector<Imath::V2f> uvs = read_vectors2(model, *accessor);
  for (Imath::V2f& uv : uvs) uv.y = 1.0f - uv.y;  // v is down
  return uvs;
}

// Draco's data are only read where the file has the same data without it.
void refuse_compressed(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                       int position) {
  const auto accessor = static_cast<std::size_t>(position);
  if (primitive.extensions.count("KHR_draco_mesh_compression") != 0 &&
      accessor < model.accessors.size() && model.accessors[accessor].bufferView < 0)
    throw GltfError("is compressed by KHR_draco_mesh_compression, which is not supported");
}

std::optional<TriangleMesh> triangles_of(const tinygltf::Model& model,
                                         const tinygltf::Primitive& primitive) {
  const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
  if (mode > TINYGLTF_MODE_TRIANGLE_FAN)
    throw GltfError(fmt::format("has mode {}; modes are 0 to 6", mode));
  if (mode != TINYGLTF_MODE_TRIANGLES && mode != TINYGLTF_MODE_TRIANGLE_STRIP &&
      mode != TINYGLTF_MODE_TRIANGLE_FAN)
    return std::nullopt;  // points and lines
  const std::optional<int> position = attribute(primitive, "POSITION");
  if (!position) return std::nullopt;  // the specification: such a primitive is skipped
  refuse_compressed(model, primitive, *position);
  TriangleMesh mesh;
  mesh.positions = read_vectors3(model, *position);
  if (const std::optional<int> normal = attribute(primitive, "NORMAL"))
    mesh.normals = read_vectors3(model, *normal);
  mesh.uvs = texture_coordinates(model, primitive, "TEXCOORD_0");
  mesh.uvs1 = texture_coordinates(model, primitive, "TEXCOORD_1");
  if (const std::optional<int> colors = attribute(primitive, "COLOR_0"))
    mesh.colors = read_colors(model, *colors, mesh.alphas);
  const std::size_t count = mesh.positions.size();
  const auto same = [&](const auto& values, const char* name) {
    if (!values.empty() && values.size() != count)
      throw GltfError(fmt::format("has attributes of different lengths: {} {}, but {} POSITION",
                                  values.size(), name, count));
  };
  same(mesh.normals, "NORMAL");
  same(mesh.uvs, "TEXCOORD_0");
  same(mesh.uvs1, "TEXCOORD_1");
  same(mesh.colors, "COLOR_0");

  std::vector<std::uint32_t> indices;
  if (primitive.indices >= 0) {
    indices = read_indices(model, primitive.indices);
  } else {
    for (std::size_t i = 0; i < count; ++i) indices.push_back(static_cast<std::uint32_t>(i));
  }
  for (std::size_t i = 0; i < indices.size(); ++i)
    if (indices[i] >= count)
      throw GltfError(
          fmt::format("index {} is {}, but there are {} vertices", i, indices[i], count));
  for (const auto& corners : triangles_of(indices, mode))
    mesh.triangles.emplace_back(static_cast<int>(corners[0]), static_cast<int>(corners[1]),
                                static_cast<int>(corners[2]));
  return mesh;
}

}  // namespace

std::string primitive_place(const tinygltf::Model& model, std::size_t mesh, std::size_t primitive) {
  const std::string& name = model.meshes[mesh].name;
  return name.empty() ? fmt::format("mesh {}, primitive {}", mesh, primitive)
                      : fmt::format("mesh {} (\"{}\"), primitive {}", mesh, name, primitive);
}

std::optional<TriangleMesh> read_primitive(const tinygltf::Model& model, std::size_t mesh,
                                           std::size_t primitive) {
  try {
    return triangles_of(model, model.meshes[mesh].primitives[primitive]);
  } catch (const GltfError& e) {
    throw GltfError(primitive_place(model, mesh, primitive) + ": " + e.what());
  }
}

}  // namespace morsel::render

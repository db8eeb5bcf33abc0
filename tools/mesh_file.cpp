// SPDX-License-Identifier: Apache-2.0
#include "tools/mesh_file.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <numeric>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace morsel::tools {
namespace {

using Bytes = std::vector<unsigned char>;

template <class T>
void append(Bytes& bytes, T value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof(T));
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

Imath::Box3d bounds_of(const topology::Mesh& mesh) {
  Imath::Box3d box;
  for (const Imath::V3d& p : mesh.positions) box.extendBy(p);
  return box;
}

// A bound on how far floats move a point with coordinates of this size: half a unit in the last
// place along each axis.
double float_rounding(const Imath::Box3d& box) {
  if (box.isEmpty()) return 0.0;
  double reach = 0.0;
  for (int i = 0; i < 3; ++i) reach = std::max({reach, std::abs(box.min[i]), std::abs(box.max[i])});
  return 0.5 * std::sqrt(3.0) * reach * std::numeric_limits<float>::epsilon();
}

constexpr double kShareOfRounding = 0.01;  // of the error

bool floats_keep_corners_apart(const topology::Mesh& mesh) {
  const auto at = [&](std::uint32_t i) { return Imath::V3f(mesh.positions[i]); };
  return std::none_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
    const Imath::V3f p = at(t[0]), q = at(t[1]), r = at(t[2]);
    return p == q || q == r || r == p;
  });
}

bool floats_will_do(const topology::Mesh& mesh, double rounding, double error) {
  return rounding <= kShareOfRounding * error && floats_keep_corners_apart(mesh);
}

void write(std::ostream& out, const Bytes& bytes) {
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
}

// A part of the binary buffer, seen as `count` elements.
int add_accessor(tinygltf::Model& model, const Bytes& bytes, std::size_t count, int target,
                 int component_type, int type) {
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = model.buffers[0].data.size();
  view.byteLength = bytes.size();
  view.target = target;
  model.buffers[0].data.insert(model.buffers[0].data.end(), bytes.begin(), bytes.end());
  model.bufferViews.push_back(view);
  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model.bufferViews.size()) - 1;
  accessor.componentType = component_type;
  accessor.count = count;
  accessor.type = type;
  model.accessors.push_back(accessor);
  return static_cast<int>(model.accessors.size()) - 1;
}

}  // namespace

double write_ply(std::ostream& out, const topology::Mesh& mesh, double error) {
  const double rounding = float_rounding(bounds_of(mesh));
  const bool as_float = floats_will_do(mesh, rounding, error);
  const char* real = as_float ? "float" : "double";
  out << fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment counter-clockwise from outside; component: id "
      "in the table of components\nelement vertex {}\nproperty {} x\nproperty {} y\nproperty {} z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty uint component\n"
      "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
      mesh.positions.size(), real, real, real, mesh.triangles.size());
  constexpr std::size_t kFlush = 1 << 20;
  Bytes bytes;
  const auto flush = [&](std::size_t limit) {
    if (bytes.size() < limit) return;
    write(out, bytes);
    bytes.clear();
  };
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (as_float)
        append(bytes, static_cast<float>(mesh.positions[i][axis]));
      else
        append(bytes, mesh.positions[i][axis]);
    }
    for (int axis = 0; axis < 3; ++axis) append(bytes, mesh.normals[i][axis]);
    append(bytes, mesh.components[i]);
    flush(kFlush);
  }
  for (const auto& t : mesh.triangles) {
    append(bytes, static_cast<unsigned char>(3));
    for (const std::uint32_t corner : t) append(bytes, corner);
    flush(kFlush);
  }
  flush(0);
  return as_float ? rounding : 0.0;
}

double write_obj(std::ostream& out, const topology::Mesh& mesh, double error) {
  const double rounding = float_rounding(bounds_of(mesh));
  const bool as_float = floats_will_do(mesh, rounding, error);
  constexpr std::size_t kFlush = 1 << 20;
  fmt::memory_buffer text;
  const auto flush = [&](std::size_t limit) {
    if (text.size() < limit) return;
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    text.clear();
  };
  const auto end = std::back_inserter(text);
  fmt::format_to(end,
                 "# counter-clockwise from outside; component_N: id in the table of components\n");
  for (const Imath::V3d& p : mesh.positions) {
    flush(kFlush);
    if (as_float)
      fmt::format_to(end, "v {} {} {}\n", static_cast<float>(p.x), static_cast<float>(p.y),
                     static_cast<float>(p.z));
    else
      fmt::format_to(end, "v {} {} {}\n", p.x, p.y, p.z);
  }
  for (const Imath::V3f& n : mesh.normals) {
    flush(kFlush);
    fmt::format_to(end, "vn {} {} {}\n", n.x, n.y, n.z);
  }
  std::vector<std::uint32_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto component = [&](std::uint32_t i) { return mesh.components[mesh.triangles[i][0]]; };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t i, std::uint32_t j) { return component(i) < component(j); });
  for (std::size_t n = 0; n < order.size(); ++n) {
    flush(kFlush);
    const auto id = component(order[n]);
    if (n == 0 || id != component(order[n - 1])) fmt::format_to(end, "g component_{}\n", id);
    const auto& t = mesh.triangles[order[n]];
    fmt::format_to(end, "f {0}//{0} {1}//{1} {2}//{2}\n", std::uint64_t{t[0]} + 1,
                   std::uint64_t{t[1]} + 1, std::uint64_t{t[2]} + 1);
  }
  flush(0);
  return as_float ? rounding : 0.0;
}

double write_glb(std::ostream& out, const topology::Mesh& mesh, double error) {
  constexpr std::uint64_t kHeader = 4096;  // more than the JSON part takes
  const std::uint64_t size = kHeader + 28 * std::uint64_t{mesh.positions.size()} +
                             12 * std::uint64_t{mesh.triangles.size()};
  if (size > std::numeric_limits<std::uint32_t>::max())
    throw std::runtime_error(
        fmt::format("the mesh takes {} bytes, but .glb ends at 4 GiB: write .ply", size));

  Imath::Box3d box = bounds_of(mesh);
  const bool moved = float_rounding(box) > kShareOfRounding * error;
  Imath::V3d origin(0.0);
  if (moved) {
    origin = box.center();
    box = {box.min - origin, box.max - origin};
  }
  const double rounding = float_rounding(box);
  if (rounding > kShareOfRounding * error)
    throw std::runtime_error(
        fmt::format("the floats of .glb are off by {:.2g} here, which is more than a hundredth of "
                    "the error {:.2g}: write .ply, which can hold doubles",
                    rounding, error));
  Bytes positions, normals, components, indices;
  std::vector<double> low(3, std::numeric_limits<double>::infinity()), high(3, -low[0]);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto x = static_cast<float>(mesh.positions[i][axis] - origin[axis]);
      append(positions, x);
      const auto a = static_cast<std::size_t>(axis);
      low[a] = std::min(low[a], double{x});
      high[a] = std::max(high[a], double{x});
      append(normals, mesh.normals[i][axis]);
    }
    append(components, static_cast<float>(mesh.components[i]));
  }
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t corner : t) append(indices, corner);

  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "morsel";
  tinygltf::Scene scene;
  if (!mesh.triangles.empty()) {
    model.buffers.resize(1);
    const std::size_t vertices = mesh.positions.size();
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    const int position = add_accessor(model, positions, vertices, TINYGLTF_TARGET_ARRAY_BUFFER,
                                      TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3);
    model.accessors[static_cast<std::size_t>(position)].minValues = low;
    model.accessors[static_cast<std::size_t>(position)].maxValues = high;
    primitive.attributes["POSITION"] = position;
    primitive.attributes["NORMAL"] =
        add_accessor(model, normals, vertices, TINYGLTF_TARGET_ARRAY_BUFFER,
                     TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3);
    primitive.attributes["_COMPONENT"] =
        add_accessor(model, components, vertices, TINYGLTF_TARGET_ARRAY_BUFFER,
                     TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR);
    primitive.indices = add_accessor(model, indices, 3 * mesh.triangles.size(),
                                     TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER,
                                     TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR);
    tinygltf::Mesh gltf_mesh;
    gltf_mesh.primitives.push_back(primitive);
    model.meshes.push_back(gltf_mesh);
    tinygltf::Node node;
    node.mesh = 0;
    if (moved) node.translation = {origin.x, origin.y, origin.z};
    model.nodes.push_back(node);
    scene.nodes.push_back(0);
  }
  model.scenes.push_back(scene);
  model.defaultScene = 0;
  tinygltf::TinyGLTF writer;
  if (!writer.WriteGltfSceneToStream(&model, out, false, true))
    throw std::runtime_error("the glTF library could not write the mesh");
  return rounding;
}

}  // namespace morsel::tools

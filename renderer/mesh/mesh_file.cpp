// SPDX-License-Identifier: Apache-2.0
#include "renderer/mesh/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <set>

#include "renderer/mesh/model_readers.h"
#include "renderer/mesh/normals.h"
#include "renderer/mesh/obj_check.h"
#include "renderer/mesh/ply_check.h"
#include "renderer/mesh/readers.h"

namespace morsel::render {
namespace {

namespace fs = std::filesystem;

std::string lower_case_extension(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool is_finite(float x) { return std::isfinite(x); }
template <class Vector>
bool is_finite(const Vector& v) {
  for (unsigned int i = 0; i < Vector::dimensions(); ++i)
    if (!std::isfinite(v[static_cast<int>(i)])) return false;
  return true;
}

template <class Vector>
void check_attribute(const std::vector<Vector>& values, std::size_t vertices, bool may_be_empty,
                     const char* what, const std::string& place) {
  if (values.size() != vertices && !(may_be_empty && values.empty()))
    throw MeshError(
        fmt::format("{}: {} {}s for {} vertices", place, values.size(), what, vertices));
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!is_finite(values[i]))
      throw MeshError(fmt::format("{}: {} of vertex {} is not a finite number", place, what, i));
}

}  // namespace

const std::vector<std::string>& mesh_extensions() {
  static const std::vector<std::string> extensions{".obj", ".ply", ".stl", ".gltf", ".glb"};
  return extensions;
}

void validate_mesh(const TriangleMesh& mesh, const std::string& place) {
  if (mesh.triangles.empty()) throw MeshError(place + ": no triangles");
  const std::size_t vertices = mesh.positions.size();
  check_attribute(mesh.positions, vertices, false, "position", place);
  check_attribute(mesh.normals, vertices, true, "normal", place);
  check_attribute(mesh.uvs, vertices, true, "texture coordinate", place);
  check_attribute(mesh.uvs1, vertices, true, "second texture coordinate", place);
  check_attribute(mesh.colors, vertices, true, "color", place);
  check_attribute(mesh.alphas, vertices, true, "alpha", place);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int corner = 0; corner < 3; ++corner) {
      const int index = mesh.triangles[t][corner];
      if (index < 0 || static_cast<std::size_t>(index) >= vertices)
        throw MeshError(fmt::format("{}: triangle {} names vertex {}, but there are {}", place, t,
                                    index, vertices));
    }
}

namespace {

// The extension of a file that is there and of a known kind.
std::string check_file(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) throw MeshError(file.string() + ": no such file");
  if (fs::is_directory(file, error)) throw MeshError(file.string() + ": is a directory");
  if (!std::ifstream(file, std::ios::binary)) throw MeshError(file.string() + ": cannot open");

  const std::string extension = lower_case_extension(file);
  const std::vector<std::string>& known = mesh_extensions();
  if (std::find(known.begin(), known.end(), extension) == known.end())
    throw MeshError(fmt::format("{}: not a mesh format that can be read; extensions: {}",
                                file.string(), fmt::join(known, ", ")));
  return extension;
}

bool is_gltf(const std::string& extension) { return extension == ".gltf" || extension == ".glb"; }

// Assimp gives a default material and says nothing.
void warn_of_missing_materials(const fs::path& file, const ObjNames& names,
                               const std::function<void(const std::string&)>& tell) {
  std::set<std::string> defined;
  for (const std::string& name : names.libraries) {
    std::ifstream library(file.parent_path() / name);
    if (!library) {
      tell(fmt::format("mtllib {}: no such file, or not readable", name));
      continue;
    }
    for (std::string line; std::getline(library, line);) {
      const std::size_t key = line.find_first_not_of(" \t");
      if (key == std::string::npos || line.compare(key, 6, "newmtl") != 0) continue;
      const std::size_t begin = line.find_first_not_of(" \t", key + 6);
      if (begin != std::string::npos)
        defined.insert(line.substr(begin, line.find_last_not_of(" \t\r") + 1 - begin));
    }
  }
  for (const std::string& name : names.materials)
    if (defined.count(name) == 0)
      tell(fmt::format("usemtl {}: no such material; a plain one is taken", name));
}

}  // namespace

Model load_model(const fs::path& file, const std::function<void(const std::string&)>& warn) {
  const auto tell = [&](const std::string& message) {
    if (warn) warn(file.string() + ": " + message);
  };
  const std::string extension = check_file(file);
  if (is_gltf(extension)) return read_gltf_model(file, tell);
  if (extension == ".obj") warn_of_missing_materials(file, check_obj(file), tell);
  if (extension == ".ply") check_ply(file);
  return read_model_with_assimp(file, tell);
}

TriangleMesh load_mesh(const fs::path& file) {
  const std::string extension = check_file(file);
  if (extension == ".obj") check_obj(file);
  if (extension == ".ply") check_ply(file);
  TriangleMesh mesh = is_gltf(extension) ? read_gltf(file) : read_with_assimp(file);
  validate_mesh(mesh, file.string());
  normalise_normals(mesh);
  return mesh;
}

}  // namespace morsel::render

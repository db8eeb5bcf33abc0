// SPDX-License-Identifier: Apache-2.0
#include "renderer/mesh/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>

#include "renderer/mesh/model_readers.h"
#include "renderer/mesh/normals.h"
#include "renderer/mesh/obj_numbers.h"
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

template <class Vector>
bool is_finite(const Vector& v) {
  for (unsigned int i = 0; i < Vector::dimensions(); ++i)
    if (!std::isfinite(v[static_cast<int>(i)])) return false;
  return true;
}

template <class Vector>
void check_attribute(const std::vector<Vector>& values, std::size_t vertices, bool may_be_empty,
                     const char* what, const fs::path& file) {
  if (values.size() != vertices && !(may_be_empty && values.empty()))
    throw MeshError(
        fmt::format("{}: {} {}s for {} vertices", file.string(), values.size(), what, vertices));
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!is_finite(values[i]))
      throw MeshError(
          fmt::format("{}: {} of vertex {} is not a finite number", file.string(), what, i));
}

}  // namespace

const std::vector<std::string>& mesh_extensions() {
  static const std::vector<std::string> extensions{".obj", ".ply", ".stl", ".gltf", ".glb"};
  return extensions;
}

void validate_mesh(const TriangleMesh& mesh, const fs::path& file) {
  if (mesh.triangles.empty()) throw MeshError(file.string() + ": no triangles");
  const std::size_t vertices = mesh.positions.size();
  check_attribute(mesh.positions, vertices, false, "position", file);
  check_attribute(mesh.normals, vertices, true, "normal", file);
  check_attribute(mesh.uvs, vertices, true, "texture coordinate", file);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int corner = 0; corner < 3; ++corner) {
      const int index = mesh.triangles[t][corner];
      if (index < 0 || static_cast<std::size_t>(index) >= vertices)
        throw MeshError(fmt::format("{}: triangle {} names vertex {}, but there are {}",
                                    file.string(), t, index, vertices));
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
  if (extension == ".obj") check_obj_numbers(file);
  return extension;
}

bool is_gltf(const std::string& extension) { return extension == ".gltf" || extension == ".glb"; }

}  // namespace

Model load_model(const fs::path& file, const std::function<void(const std::string&)>& warn) {
  const auto tell = [&](const std::string& message) {
    if (warn) warn(file.string() + ": " + message);
  };
  return is_gltf(check_file(file)) ? read_gltf_model(file, tell)
                                   : read_model_with_assimp(file, tell);
}

TriangleMesh load_mesh(const fs::path& file) {
  TriangleMesh mesh = is_gltf(check_file(file)) ? read_gltf(file) : read_with_assimp(file);
  validate_mesh(mesh, file);
  normalise_normals(mesh);
  return mesh;
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
// A mesh or model file; the first byte chooses the format.
#include <string>

#include "renderer/mesh/mesh_file.h"
#include "renderer/mesh/normals.h"
#include "renderer/scene/model.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/target.h"

namespace {

using morsel::test::require;
using namespace morsel::render;

void check_mesh(const TriangleMesh& mesh) {
  validate_mesh(mesh, "a loaded mesh");  // throws, which nobody catches
  for (const Imath::V3f& n : mesh.normals)
    require(std::abs(n.length() - 1.0f) < 1e-3f, "normals have unit length");
  require(smooth_normals(mesh).size() == mesh.positions.size(), "every vertex gets a normal");
}

void check_model(const Scene& scene) {
  for (const Instance& i : scene.instances) {
    require(i.geometry < scene.geometries.size(), "an instance has a geometry");
    require(i.material < scene.materials.size(), "an instance has a material");
  }
  for (const Geometry& g : scene.geometries)
    if (const auto* mesh = std::get_if<TriangleMesh>(&g.shape))
      validate_mesh(*mesh, "a mesh of a loaded model");
  for (const Material& m : scene.materials)
    for (const std::uint32_t t : m.textures)
      require(t == kNoTexture || t < scene.textures.size(), "a material's textures are there");
}

// MeshError that names the file, or a result that keeps its promises.
template <class Load>
void attempt(const std::filesystem::path& file, const Load& load) {
  try {
    load();
  } catch (const MeshError& e) {
    require(std::string(e.what()).starts_with(file.string()), "an error names its file");
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kLongest = 1 << 15;
  if (size == 0 || size > kLongest) return 0;
  morsel::test::Input in(data, size);
  // Letters, so that a corpus can be read: "o", "p", "s", "g" and "b" and what is 5 apart.
  static const std::string kFormats[5] = {"o.obj", "p.ply", "s.stl", "g.gltf", "b.glb"};
  const char letter = static_cast<char>(in.byte());
  const std::string* format = &kFormats[static_cast<unsigned char>(letter) % 5];
  for (const std::string& f : kFormats)
    if (f[0] == letter) format = &f;
  const auto file = morsel::test::scratch_folder() / ("mesh" + format->substr(1));
  morsel::test::write_file(file, in.rest());
  TriangleMesh mesh;
  Model model;
  attempt(file, [&] { check_mesh(mesh = load_mesh(file)); });
  attempt(file, [&] { check_model((model = load_model(file, {})).scene); });
  return 0;
}

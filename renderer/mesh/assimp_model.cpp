// SPDX-License-Identifier: Apache-2.0
#include <assimp/material.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "renderer/mesh/assimp_mesh.h"
#include "renderer/mesh/mesh_file.h"
#include "renderer/mesh/model_readers.h"
#include "renderer/mesh/normals.h"

namespace morsel::render {
namespace {

using Imath::V3f;

V3f color(const aiMaterial& from, const char* key, const V3f& fallback) {
  aiColor3D c;
  if (from.Get(key, 0, 0, c) != AI_SUCCESS) return fallback;
  return {c.r, c.g, c.b};
}
float number(const aiMaterial& from, const char* key, float fallback) {
  float x = fallback;
  return from.Get(key, 0, 0, x) == AI_SUCCESS && std::isfinite(x) ? x : fallback;
}

V3f shares(const V3f& c) {
  return {std::clamp(c.x, 0.0f, 1.0f), std::clamp(c.y, 0.0f, 1.0f), std::clamp(c.z, 0.0f, 1.0f)};
}

// MTL is Phong's world: Ns becomes the GGX width of about the same highlight (Walter et al. 2007,
// alpha = sqrt(2 / (Ns + 2))), Ks scales the reflection of index 1.5.
class Converter {
 public:
  Converter(const std::filesystem::path& file, const std::function<void(const std::string&)>& warn,
            Scene& scene)
      : folder_(file.parent_path()), warn_(warn), scene_(scene) {}

  Material convert(const aiMaterial& from, unsigned index) {
    Material m;
    m.type = MaterialType::kPrincipled;
    aiString name;
    m.name = from.Get(AI_MATKEY_NAME, name) == AI_SUCCESS && name.length > 0
                 ? name.C_Str()
                 : fmt::format("material {}", index);
    m.color = shares(color(from, "$clr.diffuse", V3f(0.6f)));
    m.emission = color(from, "$clr.emissive", V3f(0.0f));
    m.opacity = std::clamp(number(from, "$mat.opacity", 1.0f), 0.0f, 1.0f);
    const float exponent = std::max(0.0f, number(from, "$mat.shininess", 0.0f));
    m.roughness =
        std::clamp(number(from, "$mat.roughnessFactor", std::pow(2.0f / (exponent + 2.0f), 0.25f)),
                   0.0f, 1.0f);
    m.metallic = std::clamp(number(from, "$mat.metallicFactor", 0.0f), 0.0f, 1.0f);
    const V3f specular = shares(color(from, "$clr.specular", V3f(1.0f)));
    m.specular = std::max({specular.x, specular.y, specular.z});
    if (m.specular > 0.0f) m.specular_color = specular / m.specular;
    const float ior = number(from, "$mat.refracti", 1.5f);
    if (ior > 1.0f && ior <= 10.0f) m.ior = ior;
    texture(from, aiTextureType_DIFFUSE, MaterialInput::kColor, ColorSpace::kAuto, m);
    texture(from, aiTextureType_EMISSIVE, MaterialInput::kEmission, ColorSpace::kAuto, m);
    texture(from, aiTextureType_OPACITY, MaterialInput::kOpacity, ColorSpace::kLinear, m);
    texture(from, aiTextureType_HEIGHT, MaterialInput::kBump, ColorSpace::kLinear, m);
    texture(from, aiTextureType_NORMALS, MaterialInput::kNormal, ColorSpace::kLinear, m);
    return m;
  }

 private:
  void texture(const aiMaterial& from, aiTextureType type, MaterialInput input, ColorSpace space,
               Material& m) {
    aiString path;
    if (from.GetTexture(type, 0, &path) != AI_SUCCESS || path.length == 0) return;
    std::string name = path.C_Str();
    std::replace(name.begin(), name.end(), '\\', '/');
    ImageTexture image;
    const std::filesystem::path file = std::filesystem::absolute(folder_ / name);
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
      warn_(
          fmt::format("material \"{}\": {}: no such image; it is left out", m.name, file.string()));
      return;
    }
    image.file = file.string();
    image.color_space = space;
    m.texture(input) = static_cast<std::uint32_t>(scene_.textures.size());
    scene_.textures.push_back(
        {fmt::format("{} {}", m.name, name), image, TextureChannel::kLuminance});
  }

  std::filesystem::path folder_;
  const std::function<void(const std::string&)>& warn_;
  Scene& scene_;
};

}  // namespace

Model read_model_with_assimp(const std::filesystem::path& file, const ObjNames& names,
                             const std::function<void(const std::string&)>& warn) {
  Assimp::Importer importer;
  const aiScene& from = read_assimp_scene(importer, file, names);
  Model model;
  Scene& scene = model.scene;
  Converter converter(file, warn, scene);
  for (unsigned i = 0; i < from.mNumMaterials; ++i)
    scene.materials.push_back(converter.convert(*from.mMaterials[i], i));
  for (unsigned i = 0; i < from.mNumMeshes; ++i) {
    const aiMesh& part = *from.mMeshes[i];
    if ((part.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) continue;
    TriangleMesh mesh;
    append_assimp_mesh(part, mesh, file);
    if (!part.HasNormals()) mesh.normals.clear();
    if (!part.HasTextureCoords(0)) mesh.uvs.clear();
    validate_mesh(mesh, fmt::format("{}: mesh {}", file.string(), i));
    normalise_normals(mesh);
    if (mesh.normals.empty()) mesh.normals = smooth_normals(mesh);
    const std::string name = part.mName.length > 0 ? part.mName.C_Str() : fmt::format("mesh {}", i);
    Instance instance;
    instance.name = name;
    instance.geometry = static_cast<std::uint32_t>(scene.geometries.size());
    instance.material = part.mMaterialIndex;
    scene.geometries.push_back({name, std::move(mesh)});
    scene.instances.push_back(std::move(instance));
  }
  if (scene.instances.empty()) throw MeshError(file.string() + ": no triangles");
  return model;
}

}  // namespace morsel::render

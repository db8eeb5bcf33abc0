// SPDX-License-Identifier: Apache-2.0
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "renderer/mesh/assimp_mesh.h"
#include "renderer/mesh/obj_groups.h"
#include "renderer/mesh/readers.h"

namespace morsel::render {
namespace {

// Validation comes first, so that the other steps and the code below meet only indices in range.
constexpr unsigned int kReading = aiProcess_ValidateDataStructure | aiProcess_RemoveComponent;
constexpr unsigned int kCleaning = aiProcess_JoinIdenticalVertices | aiProcess_SortByPType;

// Leave out colours, tangents and materials: joining vertices would otherwise keep two vertices
// apart that differ in nothing we read.
constexpr int kUnused = aiComponent_COLORS | aiComponent_TANGENTS_AND_BITANGENTS |
                        aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS | aiComponent_TEXTURES |
                        aiComponent_LIGHTS | aiComponent_CAMERAS;

bool has_polygons(const aiScene& scene) {
  for (unsigned int m = 0; m < scene.mNumMeshes; ++m)
    for (unsigned int i = 0; i < scene.mMeshes[m]->mNumFaces; ++i)
      if (scene.mMeshes[m]->mFaces[i].mNumIndices > 3) return true;
  return false;
}

const aiScene* read_scene(Assimp::Importer& importer, const std::string& file) {
  const aiScene* scene = importer.ReadFile(file, kReading);
  if (scene == nullptr) return nullptr;
  // Debian's assimp keeps its assertions, and one in the triangulation ends the process when there
  // is nothing to triangulate but, say, a line.
  const unsigned int triangulate = has_polygons(*scene) ? aiProcess_Triangulate : 0u;
  return importer.ApplyPostProcessing(kCleaning | triangulate);
}

}  // namespace

void append_assimp_mesh(const aiMesh& part, TriangleMesh& mesh, const std::filesystem::path& file) {
  const std::size_t first = mesh.positions.size();
  if (first + part.mNumVertices > 0x7fffffffu)
    throw MeshError(file.string() + ": more than 2^31 vertices");
  for (unsigned int i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& p = part.mVertices[i];
    mesh.positions.emplace_back(p.x, p.y, p.z);
    if (part.HasNormals())
      mesh.normals.emplace_back(part.mNormals[i].x, part.mNormals[i].y, part.mNormals[i].z);
    else
      mesh.normals.emplace_back(0.0f);  // becomes a smooth one, if another part has normals
    if (part.HasTextureCoords(0))
      mesh.uvs.emplace_back(part.mTextureCoords[0][i].x, part.mTextureCoords[0][i].y);
    else
      mesh.uvs.emplace_back(0.0f);
  }
  for (unsigned int i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;
    Imath::V3i triangle;
    for (int corner = 0; corner < 3; ++corner)
      triangle[corner] = static_cast<int>(first + face.mIndices[corner]);
    mesh.triangles.push_back(triangle);
  }
}

const aiScene& read_assimp_scene(Assimp::Importer& importer, const std::filesystem::path& file,
                                 const ObjNames& names) {
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, kUnused);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = nullptr;
  try {
    if (names.smoothing_groups)  // which belongs to the importer then
      importer.SetIOHandler(read_groups_as_normals(file, names).release());
    scene = read_scene(importer, file.string());
  } catch (const std::exception& e) {  // e.g. bad_alloc for a header that claims 10^18 vertices
    throw MeshError(fmt::format("{}: {}", file.string(), e.what()));
  }
  if (scene == nullptr)
    throw MeshError(fmt::format("{}: {}", file.string(), importer.GetErrorString()));
  return *scene;
}

TriangleMesh read_with_assimp(const std::filesystem::path& file, const ObjNames& names) {
  Assimp::Importer importer;
  const aiScene& scene = read_assimp_scene(importer, file, names);

  // In these three formats every node has the identity transform: meshes can be taken as they are.
  TriangleMesh mesh;
  bool any_normals = false, any_uvs = false;
  for (unsigned int i = 0; i < scene.mNumMeshes; ++i) {
    const aiMesh& part = *scene.mMeshes[i];
    if ((part.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) continue;
    append_assimp_mesh(part, mesh, file);
    any_normals = any_normals || part.HasNormals();
    any_uvs = any_uvs || part.HasTextureCoords(0);
  }
  if (!any_normals) mesh.normals.clear();
  if (!any_uvs) mesh.uvs.clear();
  return mesh;
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/scene_identity.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <new>

#include "renderer/scene/scene_json.h"

namespace morsel::render {
namespace {

using nlohmann::json;

class Hash {
 public:
  Hash() : state_(XXH3_createState(), &XXH3_freeState) {
    if (!state_) throw std::bad_alloc();
    XXH3_128bits_reset(state_.get());
  }
  void add(const void* data, std::size_t bytes) { XXH3_128bits_update(state_.get(), data, bytes); }
  template <class T>
  void add_array(const std::vector<T>& values) {
    const std::uint64_t count = values.size();
    add(&count, sizeof count);
    if (!values.empty()) add(values.data(), values.size() * sizeof(T));
  }
  void add_file(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::vector<char> block(1 << 20);
    while (in) {
      in.read(block.data(), static_cast<std::streamsize>(block.size()));
      add(block.data(), static_cast<std::size_t>(in.gcount()));
    }
    if (!in.eof())
      throw std::runtime_error(
          fmt::format("{}: cannot read: {}", file.string(), std::strerror(errno)));
  }
  std::string text() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
  }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

std::string file_hash(const std::filesystem::path& file) {
  Hash hash;
  hash.add_file(file);
  return hash.text();
}

std::string mesh_hash(const TriangleMesh& mesh) {
  Hash hash;
  hash.add_array(mesh.positions);
  hash.add_array(mesh.normals);
  hash.add_array(mesh.uvs);
  hash.add_array(mesh.triangles);
  return hash.text();
}

// A file, or the tiles that <UDIM> stands for.
std::string image_hash(const std::string& file) {
  constexpr std::string_view kUdim = "<UDIM>";
  const std::size_t at = file.find(kUdim);
  if (at == std::string::npos) return file_hash(file);
  const std::string before = file.substr(0, at), after = file.substr(at + kUdim.size());
  std::vector<std::string> tiles;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(file).parent_path())) {
    const std::string name = entry.path().string();
    if (entry.is_regular_file() && name.size() == before.size() + 4 + after.size() &&
        name.starts_with(before) && name.ends_with(after))
      tiles.push_back(name);
  }
  std::sort(tiles.begin(), tiles.end());
  Hash hash;
  for (const std::string& tile : tiles) {
    hash.add(tile.data() + before.size(), 4);
    hash.add_file(tile);
  }
  return hash.text();
}

json images(const Scene& scene) {
  json hashes = json::array();
  for (const Texture& texture : scene.textures)
    if (const auto* image = std::get_if<ImageTexture>(&texture.kind); image && !image->data)
      hashes.push_back(image_hash(image->file));
  return hashes;
}

// Materials and lights of a model are in its own file or, for an OBJ, in those that it names.
json model_files(const SceneDocument& document) {
  json hashes = json::object();
  const auto models = document.root().find("models");
  if (models == document.root().end()) return hashes;
  for (const json& model : *models) {
    const std::string name = model["file"].get<std::string>();
    const std::filesystem::path file = document.resolve(name);
    hashes[name] = file_hash(file);
    if (file.extension() != ".obj") continue;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
      if (!line.starts_with("mtllib ")) continue;
      std::string library = line.substr(7);
      while (!library.empty() && std::isspace(static_cast<unsigned char>(library.back())))
        library.pop_back();
      const std::filesystem::path beside = file.parent_path() / library;
      if (std::filesystem::is_regular_file(beside)) hashes[library] = file_hash(beside);
    }
  }
  return hashes;
}

}  // namespace

json scene_identity(const std::filesystem::path& file, const std::vector<Override>& overrides,
                    const LoadedScene& loaded, bool with_spp) {
  const SceneDocument document(file, overrides);
  json scene = document.root();
  for (const char* key : {"description", "$schema"}) scene.erase(key);
  json& render = scene.emplace("render", json::object()).first.value();
  for (const char* key : {"exposure", "texture_memory", "denoise", "spp"}) render.erase(key);
  if (with_spp) render["spp"] = loaded.scene.settings.spp;
  if (scene.contains("geometries"))
    for (json& geometry : scene["geometries"]) geometry.erase("cache");

  json meshes = json::object();
  for (const Geometry& g : loaded.scene.geometries)
    if (const auto* mesh = std::get_if<TriangleMesh>(&g.shape)) meshes[g.name] = mesh_hash(*mesh);
  json files{
      {"meshes", meshes}, {"images", images(loaded.scene)}, {"models", model_files(document)}};
  if (loaded.scene.environment && !loaded.scene.environment->file.empty())
    files["environment"] = file_hash(loaded.scene.environment->file);
  return {{"morsel", MORSEL_VERSION}, {"scene", scene}, {"content", files}};
}

std::string hash_of(const json& identity) {
  Hash hash;
  const std::string text = identity.dump();
  hash.add(text.data(), text.size());
  return hash.text();
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "renderer/math/affine.h"
#include "renderer/mesh/gltf_material.h"
#include "renderer/mesh/mesh_file.h"
#include "renderer/mesh/model_readers.h"
#include "renderer/mesh/normals.h"

namespace morsel::render {
namespace {

using Imath::V3d;
using Imath::V3f;

constexpr double kDegrees = 180.0 / 3.14159265358979323846;

V3f direction(const Imath::M44d& m, const V3d& d) {
  V3d moved;
  m.multDirMatrix(d, moved);
  return V3f(moved.normalized());
}

class Importer {
 public:
  Importer(const tinygltf::Model& model, const std::filesystem::path& file,
           const std::function<void(const std::string&)>& warn)
      : model_(model), file_(file), warn_(warn) {}

  Model import() {
    add_gltf_materials(model_, warn_, scene_);
    if (model_.scenes.empty()) {
      for (std::size_t i = 0; i < model_.meshes.size(); ++i)
        add_instances(static_cast<int>(i), model_.meshes[i].name, Imath::M44d());
    } else {
      for_each_node(model_, [&](const tinygltf::Node& node, int index, const Imath::M44d& m) {
        const std::string name = node.name.empty() ? fmt::format("node {}", index) : node.name;
        if (node.mesh >= 0) add_instances(node.mesh, name, m);
        if (node.skin >= 0) warn_(fmt::format("\"{}\": skinning is not applied", name));
        if (node.camera >= 0) add_camera(node.camera, m);
        add_light(node, name, m);
      });
    }
    if (scene_.instances.empty()) throw GltfError("no triangles");
    if (!model_.animations.empty()) warn_("animations are left out");
    return std::move(result_);
  }

 private:
  // Geometries of a mesh's primitives, made when a node asks for the first time.
  const std::vector<std::pair<std::uint32_t, std::uint32_t>>& primitives_of(int mesh) {
    const auto [it, added] = meshes_.try_emplace(mesh);
    if (!added) return it->second;
    const tinygltf::Mesh& from = model_.meshes[static_cast<std::size_t>(mesh)];
    for (std::size_t i = 0; i < from.primitives.size(); ++i) {
      auto part = read_primitive(model_, static_cast<std::size_t>(mesh), i);
      if (!part || part->triangles.empty()) continue;
      const std::string place = primitive_place(model_, static_cast<std::size_t>(mesh), i);
      validate_mesh(*part, fmt::format("{}: {}", file_.string(), place));
      normalise_normals(*part);  // without normals there are facets, as the specification asks
      const int material = from.primitives[i].material;
      if (material >= static_cast<int>(model_.materials.size()))
        throw GltfError(fmt::format("{} names material {}, which does not exist; there are {}",
                                    place, material, model_.materials.size()));
      const auto index = static_cast<std::uint32_t>(
          material < 0 ? static_cast<int>(model_.materials.size()) : material);
      // Opaque materials have no use for alpha.
      const std::string mode =
          material < 0 ? "" : model_.materials[static_cast<std::size_t>(material)].alphaMode;
      if (!part->alphas.empty() && !mode.empty() && mode != "OPAQUE" &&
          *std::min_element(part->alphas.begin(), part->alphas.end()) < 1.0f)
        scene_.materials[index].vertex_alpha = true;
      it->second.emplace_back(static_cast<std::uint32_t>(scene_.geometries.size()), index);
      scene_.geometries.push_back(
          {fmt::format("{} {}", from.name.empty() ? fmt::format("mesh {}", mesh) : from.name, i),
           std::move(*part)});
    }
    return it->second;
  }

  void add_instances(int mesh, const std::string& name, const Imath::M44d& m) {
    if (!is_invertible(m)) {  // scaled to nothing: how files hide things
      warn_(fmt::format("\"{}\" has a transform that flattens it; it is left out", name));
      return;
    }
    for (const auto& [geometry, material] : primitives_of(mesh)) {
      Instance instance;
      instance.name =
          names_.insert(name).second ? name : fmt::format("{} {}", name, scene_.instances.size());
      names_.insert(instance.name);
      instance.geometry = geometry;
      instance.material = material;
      instance.object_to_world = m;
      scene_.instances.push_back(std::move(instance));
    }
  }

  void add_camera(int index, const Imath::M44d& m) {
    if (result_.has_camera || static_cast<std::size_t>(index) >= model_.cameras.size()) return;
    const tinygltf::Camera& from = model_.cameras[static_cast<std::size_t>(index)];
    SceneCamera& camera = scene_.camera;
    camera.position = V3f(m.translation());
    camera.look_at = camera.position + direction(m, V3d(0, 0, -1));
    camera.up = direction(m, V3d(0, 1, 0));
    if (from.type == "orthographic") {
      camera.projection = Projection::kOrthographic;
      if (from.orthographic.ymag > 0.0)
        camera.height = static_cast<float>(2.0 * from.orthographic.ymag);
    } else if (from.perspective.yfov > 0.0 && from.perspective.yfov < 3.1) {
      camera.vertical_fov = static_cast<float>(from.perspective.yfov * kDegrees);
    }
    result_.has_camera = true;
  }

  // Intensities are photometric in the file and taken as they are: one unit stands for a candela,
  // or a lux.
  void add_light(const tinygltf::Node& node, const std::string& name, const Imath::M44d& m) {
    const auto extension = node.extensions.find("KHR_lights_punctual");
    if (extension == node.extensions.end() || !extension->second.Has("light")) return;
    const int index = extension->second.Get("light").GetNumberAsInt();
    if (index < 0 || static_cast<std::size_t>(index) >= model_.lights.size())
      throw GltfError(fmt::format("\"{}\" names light {}, which does not exist", name, index));
    const tinygltf::Light& from = model_.lights[static_cast<std::size_t>(index)];
    V3f color(1.0f);
    for (std::size_t i = 0; i < 3 && i < from.color.size(); ++i)
      color[static_cast<int>(i)] = static_cast<float>(from.color[i]);
    color *= static_cast<float>(from.intensity);
    const V3f towards = direction(m, V3d(0, 0, -1));
    if (from.type == "directional") {
      DistantLight light;
      light.name = name;
      light.direction = towards;
      light.irradiance = color;
      scene_.distants.push_back(light);
      return;
    }
    PointLight light;
    light.name = name;
    light.position = V3f(m.translation());
    light.direction = towards;
    light.intensity = color;
    if (from.type == "spot") {
      light.inner_angle = static_cast<float>(from.spot.innerConeAngle * kDegrees);
      light.outer_angle = static_cast<float>(from.spot.outerConeAngle * kDegrees);
    }
    scene_.points.push_back(light);
  }

  const tinygltf::Model& model_;
  const std::filesystem::path& file_;
  const std::function<void(const std::string&)>& warn_;
  Model result_;
  Scene& scene_ = result_.scene;
  std::map<int, std::vector<std::pair<std::uint32_t, std::uint32_t>>> meshes_;
  std::set<std::string> names_;
};

}  // namespace

Model read_gltf_model(const std::filesystem::path& file,
                      const std::function<void(const std::string&)>& warn) {
  try {
    Model model = Importer(parse_gltf(file), file, warn).import();
    for (Texture& t : model.scene.textures)  // for the message should it not be an image after all
      if (auto* image = std::get_if<ImageTexture>(&t.kind))
        image->description = file.string() + ": " + image->description;
    return model;
  } catch (const MeshError&) {
    throw;
  } catch (const std::exception& e) {  // GltfError, or bad_alloc for absurd sizes
    throw MeshError(fmt::format("{}: {}", file.string(), e.what()));
  }
}

}  // namespace morsel::render

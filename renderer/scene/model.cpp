// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/model.h"

#include <iterator>

namespace morsel::render {
namespace {

using Imath::V3d;
using Imath::V3f;

V3f moved(const V3f& p, const Imath::M44d& m) { return V3f(V3d(p) * m); }
V3f turned(const V3f& d, const Imath::M44d& m) {
  V3d out;
  m.multDirMatrix(V3d(d), out);
  return V3f(out.normalized());
}

template <class T>
void append(std::vector<T>& to, std::vector<T>& from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

}  // namespace

void add_model(Model model, const ModelPlacement& placement, Scene& scene) {
  Scene& from = model.scene;
  const auto textures = static_cast<std::uint32_t>(scene.textures.size());
  const auto materials = static_cast<std::uint32_t>(scene.materials.size());
  const auto geometries = static_cast<std::uint32_t>(scene.geometries.size());
  const std::string prefix = placement.name + "/";
  for (Material& m : from.materials) {
    m.name = prefix + m.name;
    for (std::uint32_t& t : m.textures)
      if (t != kNoTexture) t += textures;
  }
  for (Instance& i : from.instances) {
    i.name = prefix + i.name;
    i.geometry += geometries;
    i.material += materials;
    i.object_to_world = i.object_to_world * placement.transform;
  }
  append(scene.textures, from.textures);
  append(scene.materials, from.materials);
  append(scene.geometries, from.geometries);
  append(scene.instances, from.instances);
  if (placement.lights) {
    for (PointLight& l : from.points) {
      l.position = moved(l.position, placement.transform);
      l.direction = turned(l.direction, placement.transform);
    }
    for (DistantLight& l : from.distants) l.direction = turned(l.direction, placement.transform);
    append(scene.points, from.points);
    append(scene.distants, from.distants);
  }
  if (placement.camera && model.has_camera) {
    SceneCamera camera = from.camera;
    camera.look_at = moved(camera.look_at, placement.transform);
    camera.position = moved(camera.position, placement.transform);
    camera.up = turned(camera.up, placement.transform);
    scene.camera = camera;
  }
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "renderer/film/matte_names.h"

namespace morsel::render {

MatteNames::MatteNames(const Scene& scene) {
  for (const Instance& i : scene.instances) {
    objects_.push_back(i.name);
    object_ids_.push_back(cryptomatte::id_of(i.name));
  }
  for (const Material& m : scene.materials) {
    materials_.push_back(m.name);
    material_ids_.push_back(cryptomatte::id_of(m.name));
  }
}

std::string MatteNames::component_name(const std::string& instance, std::uint32_t component) {
  return instance + "/" + std::to_string(component);
}

std::uint32_t MatteNames::id(Matte matte, const PathSample& sample) const {
  if (sample.instance >= objects_.size()) return 0;
  switch (matte) {
    case Matte::kObject:
      return object_ids_[sample.instance];
    case Matte::kMaterial:
      return sample.material < material_ids_.size() ? material_ids_[sample.material] : 0;
    case Matte::kComponent:
      break;
  }
  if (!(sample.component > 0.0f)) return 0;
  return cryptomatte::id_of(
      component_name(objects_[sample.instance], static_cast<std::uint32_t>(sample.component) - 1));
}

std::map<std::string, std::uint32_t> MatteNames::manifest(Matte matte, const Film& film) const {
  std::map<std::string, std::uint32_t> ids;
  if (matte == Matte::kObject)
    for (const std::string& name : objects_) ids[name] = cryptomatte::id_of(name);
  if (matte == Matte::kMaterial)
    for (const std::string& name : materials_) ids[name] = cryptomatte::id_of(name);
  if (matte == Matte::kComponent)
    for (const auto& [instance, component] : film.seen_components()) {
      const std::string name = component_name(objects_[instance], component);
      ids[name] = cryptomatte::id_of(name);
    }
  return ids;
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "renderer/film/film.h"

namespace morsel::render {

// The three mattes of an image and the hashes of what they can show.
enum class Matte { kObject, kMaterial, kComponent };
inline constexpr const char* kMatteLayers[] = {"crypto_object", "crypto_material",
                                               "crypto_component"};
inline constexpr std::size_t kMattes = 3;

// Names by which samples are told apart: instances, materials, and components as
// "instance/component"; instances and materials of the same name are one.
class MatteNames {
 public:
  explicit MatteNames(const Scene& scene);

  std::uint32_t id(Matte matte, const PathSample& sample) const;
  // Of the components of those instances that `film` shows, all objects, all materials.
  std::map<std::string, std::uint32_t> manifest(Matte matte, const Film& film) const;

  static std::string component_name(const std::string& instance, std::uint32_t component);

 private:
  std::vector<std::string> objects_, materials_;
  std::vector<std::uint32_t> object_ids_, material_ids_;
};

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "renderer/scene/load_scene.h"

namespace morsel::render {

// Everything that decides the pixels of a scene, as a document that can be compared: the scene file
// with its overrides, a fingerprint of every file that it names, by content and not by place, and
// the version of Morsel. Left out is what changes no pixel (exposure, memory limits, where caches
// lie), and the number of samples unless `with_spp`: more of them can be added to a render later,
// but not where a pixel's samples depend on their number (adaptive sampling, shards).
nlohmann::json scene_identity(const std::filesystem::path& file,
                              const std::vector<Override>& overrides, const LoadedScene& loaded,
                              bool with_spp);

// 32 hexadecimal digits.
std::string hash_of(const nlohmann::json& identity);

}  // namespace morsel::render

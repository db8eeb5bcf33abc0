// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "renderer/scene/overrides.h"
#include "renderer/scene/scene.h"
#include "topology/certified.h"

namespace morsel::render {

struct LoadOptions {
  topology::Execution execution;                 // of caches that are built, and of bricks
  std::function<void(const std::string&)> warn;  // may be empty
  std::function<void(const std::filesystem::path&)> check_image;
  // ^ throws std::runtime_error when the image cannot be read; called early, so that minutes of
  // other work are not lost. May be empty: then only that the file is there is checked.
  // Bytes that the bricks of a hypertexture may have to be kept in files beside its topology cache.
  // 0: such files are neither read nor written.
  std::uint64_t max_brick_file = 0;
};

// What loading a hypertexture geometry took.
struct HypertextureReport {
  std::string geometry;
  std::filesystem::path cache_file;
  bool built = false;          // rather than read
  double build_seconds = 0.0;  // of the cache, whenever it was built
  std::uint64_t components = 0, kept = 0;
  bool certified = false;
  std::uint64_t bricks = 0;
  bool bricks_were_read = false;  // rather than made
  std::uint64_t bytes = 0;        // of the geometry in memory
};

struct LoadedScene {
  Scene scene;
  std::vector<HypertextureReport> hypertextures;
};

// Reads a scene file with everything that it refers to. Geometries that no instance uses are
// checked, but neither loaded nor built (a warning says so). Throws params::InputError for invalid
// input, topology::CacheError for a cache that is there but unusable, topology::Cancelled.
LoadedScene load_scene(const std::filesystem::path& file, const std::vector<Override>& overrides,
                       const LoadOptions& options = {});

// Reads the same, but builds nothing and goes on after a problem: returns all problems found, each
// as load_scene would say it. Empty: load_scene will accept the scene.
std::vector<std::string> check_scene(const std::filesystem::path& file,
                                     const std::vector<Override>& overrides,
                                     const LoadOptions& options = {});

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "renderer/film/film.h"

namespace morsel::render {

// Shards put together.
struct MergedShards {
  Film film;
  std::vector<V3f> denoised;  // see RenderResult; if the scene asks for it
  float exposure = 0.0f;
  int spp = 0;               // that the scene asked for
  std::uint32_t shards = 0;  // that the render was split into
  std::vector<std::uint32_t> missing;
  std::vector<std::filesystem::path> unfinished;  // shards that were interrupted
};

// Adds the samples of `files`, which `render --shard` wrote, and writes the picture that one render
// would have written, bit by bit where all shards are there, to `exr`. Missing and unfinished
// shards leave a picture with fewer samples. One file after the other is in memory. Throws
// std::runtime_error that names the file when it is no shard, of another scene, or the same shard
// as another one.
MergedShards merge_shards(const std::vector<std::filesystem::path>& files,
                          const std::filesystem::path& exr);

}  // namespace morsel::render

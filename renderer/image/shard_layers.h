// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenEXR/ImfHeader.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "renderer/film/film_sums.h"
#include "renderer/image/exr_layers.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// What a shard's EXR has beside its picture, whole numbers of 32 bits each:
//   shard.pixel.H.WW         word WW of the accumulator of half H (PixelAccumulator as it is in
//                            memory; half 1 with adaptive sampling only)
//   shard.group.G.H.WW       of the light group's sum
//   shard.matte.M.KK.id, .n  the KK-th name of matte M, and its samples
// and in the header, beside what every picture has:
//   morsel:sceneHash         of the scene's identity (scene_identity.h)
//   morsel:shard             "INDEX/COUNT"
//   morsel:shardFormat       1; of the layout above
//   morsel:lightGroups       names
//   morsel:denoise           1: the whole picture is to get a denoised layer
// They are lossless: adding the sums of all shards gives the sums of one render.
std::vector<ExrWords> shard_words(FilmSums& sums);
void add_shard_attributes(Imf::Header& header, const Scene& scene, FilmSums& sums,
                          const std::string& scene_hash);

// A shard read back.
struct ShardFile {
  std::filesystem::path file;
  Imf::Header header;
  std::string scene_hash;
  int spp = 0;
  std::vector<std::string> light_groups;
  std::unique_ptr<FilmSums> sums;
};
// Throws std::runtime_error that names the file when it is not a shard, or is damaged.
ShardFile read_shard(const std::filesystem::path& file);

}  // namespace morsel::render

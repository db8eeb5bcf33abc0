// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "renderer/film/film_sums.h"

namespace morsel::render {

// What is wrong with a checkpoint: the message names the file.
struct CheckpointError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// What a checkpoint belongs to and what it took so far.
struct CheckpointInfo {
  nlohmann::json identity;  // of the scene: see scene_identity.h
  double seconds = 0.0;     // of rendering, over all runs
};

// Writes the sums as they stand while rendering goes on; a tile of the image is held up for the
// time that copying it takes. A file of sections (topology/section_file.h) with checksums, which
// appears under its name only when it is complete. Returns its size. Throws CheckpointError.
std::uint64_t write_checkpoint(const std::filesystem::path& file, FilmSums& sums,
                               const CheckpointInfo& info);

// Fills `sums`, which must be empty and of the layout and shard that were written. Throws
// CheckpointError when the file is missing, damaged, or of another scene, and then says what has
// changed.
CheckpointInfo read_checkpoint(const std::filesystem::path& file, const nlohmann::json& identity,
                               FilmSums& sums);

// The first few differences of two documents, for people: "/render/max_depth was 8, is 4".
std::string differences(const nlohmann::json& before, const nlohmann::json& now);

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "renderer/film/film.h"

namespace morsel::render {

// Writes an 8-bit RGBA preview of the film's window (a crop is a smaller picture), tone mapped as
// tone_map.h says. Where alpha is below 1 the colour is divided by it first: PNG is unassociated.
// Appears under `path` only when complete; throws std::runtime_error that names the file.
// Of `denoised` radiance (see RenderResult) if there is any.
void write_png(const std::filesystem::path& path, const Film& film, float exposure,
               const std::vector<V3f>& denoised = {});

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfPixelType.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "renderer/film/film.h"

namespace morsel::render {

struct ExrChannel {
  std::string name;
  Imf::PixelType type;  // HALF or FLOAT
  std::function<float(const Film&, int x, int y)> value;
};

// The layers that exr.h lists, in its order; `light_groups` are their names. `denoised` may be
// empty and must outlive the channels.
std::vector<ExrChannel> picture_channels(const std::vector<std::string>& light_groups,
                                         const Film& film, const std::vector<V3f>& denoised);

// A channel of whole numbers, row by row.
struct ExrWords {
  std::string name;
  std::vector<std::uint32_t> plane;
};

// Writes the film's channels, and more, under `header`, whose list of channels is filled in. Values
// outside half's range are clamped to it. Appears under `path` only when complete; throws
// std::runtime_error that names the file.
void write_planes(const std::filesystem::path& path, Imf::Header header,
                  const std::vector<ExrChannel>& channels, const Film& film,
                  const std::vector<ExrWords>& words = {});

}  // namespace morsel::render

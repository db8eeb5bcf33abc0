// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "renderer/film/film.h"

namespace morsel::render {

// The version of Intel's Open Image Denoise that this build has, as "2.3.1"; empty if it has none.
std::string denoiser_version();

// The film's radiance with its noise taken out, row by row of its window, guided by albedo and
// normal (the filter "RT", high dynamic range). Biased, as every such filter is: a layer beside the
// rendered one, never in its place. Throws std::runtime_error when the library reports an error and
// when this build has none.
std::vector<V3f> denoise(const Film& film);

}  // namespace morsel::render

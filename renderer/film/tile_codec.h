// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "renderer/film/film_sums.h"

namespace morsel::render {

// A tile as bytes, little-endian.
void append_tile(const TileSums& tile, std::vector<std::byte>& bytes);

// Reads what append_tile() wrote from the front of `bytes` into a tile of the same layout. Returns
// what is left. Throws std::runtime_error when the bytes cannot be those of such a tile.
std::span<const std::byte> read_tile(std::span<const std::byte> bytes, TileSums& tile);

}  // namespace morsel::render

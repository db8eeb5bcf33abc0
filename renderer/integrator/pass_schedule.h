// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace morsel::render {

// Samples of each pixel at the ends of the passes in which an image is rendered: `first`, then
// doubling while that is a small step, then growing by an eighth, but 16 to 64, to `last`. Early
// passes show all of the image soon; later ones are long enough for their cost not to matter, and
// short enough for all pixels to have about as many samples whenever a render is stopped.
std::vector<std::uint32_t> pass_schedule(std::uint32_t first, std::uint32_t last);

}  // namespace morsel::render

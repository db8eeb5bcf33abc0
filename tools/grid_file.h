// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <iosfwd>

#include "topology/box.h"

namespace morsel::tools {

// Samples of a scalar on n x n x n points: point (i, j, k) is at min + (max - min) * (i, j, k) /
// (n - 1), so the outermost samples lie on the box's faces. The samples themselves follow the
// header as little-endian doubles, x fastest, then y, then z.

// NumPy format 1.0: an array of shape (n, n, n), C order, index [z][y][x].
void write_npy_header(std::ostream& out, std::size_t n);

// VTK XML ImageData with one point array "F", appended raw; needs the footer after the samples.
void write_vti_header(std::ostream& out, std::size_t n, const topology::Box& box);
void write_vti_footer(std::ostream& out);

}  // namespace morsel::tools

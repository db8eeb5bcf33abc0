// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "topology/morse/morse_complex.h"

namespace morsel::topology {

// The segmentation of figure 5: critical points by decreasing F; a maximum begins a set, a 2-saddle
// joins the sets of the two maxima that its separatrices end in. `ends` as trace_separatrices fills
// it. Fills complex.sets, complex.main, the bounds of the number of sets, and `set` of every point
// whose set is known. complex.points must be by decreasing F.
void segment(MorseComplex& complex, const std::vector<std::uint32_t>& ends);

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "topology/morse/morse_complex.h"

namespace morsel::topology {

// Certifies a basin for every maximum of complex.points (see basin.h).
void find_basins(const ScalarField& field, MorseComplex& complex);

// Integrates both separatrices of every 2-saddle of complex.points (section 5.4 of the paper) and
// one ascent from every 1-saddle and minimum (section 8). An ascent that ends in no basin is tried
// again with tighter tolerances, then listed in complex.lost. Fills complex.separatrices, and
// `ends`: for 1-saddles and minima the maximum that was reached, else Separatrix::kNoMaximum.
void trace_separatrices(const ScalarField& field, MorseComplex& complex, bool paths,
                        std::vector<std::uint32_t>& ends, const Execution& execution);

}  // namespace morsel::topology

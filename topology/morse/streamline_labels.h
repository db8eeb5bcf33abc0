// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "topology/certified.h"
#include "topology/morse/morse_complex.h"

namespace morsel::topology {

// Labels the octree's cells as the paper does surface points: by an ascent from a point of S in
// each cell to a maximum and its set. The table, the count and its bounds then come from the Morse
// engine alone; of `topology` only the cells and their contents are used. `complex` gets the new
// ids (by decreasing volume) as sets. A cell whose ascent is lost is counted as unresolved.
void label_by_streamlines(const ScalarField& field, MorseComplex& complex, Topology& topology,
                          const Execution& execution = {});

}  // namespace morsel::topology

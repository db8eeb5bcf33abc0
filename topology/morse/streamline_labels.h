// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "topology/certified.h"
#include "topology/morse/morse_complex.h"

namespace morsel::topology {

// Labels the octree's cells as the paper does surface points: by an ascent from a point of S in
// each cell to a maximum and its set. The table, the count and its bounds then come from the Morse
// engine alone; of `topology` only the cells and their contents are used. `complex` gets the new
// ids (by decreasing volume) as sets. Ascents are those of the field that the complex was found in,
// perturbed if it was. A cell whose ascent is lost becomes undecided and counts as unresolved, as
// do those that were undecided; for rendering they belong where most of their surroundings do.
// Faces are of no consequence here: none counts as unresolved.
void label_by_streamlines(const ScalarField& field, MorseComplex& complex, Topology& topology,
                          const Execution& execution = {});

}  // namespace morsel::topology

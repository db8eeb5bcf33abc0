// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "topology/certified.h"
#include "topology/morse/morse_complex.h"

namespace morsel::topology {

// The two engines against each other: every maximum's certified label must follow from its set and
// the other way round, and per component maxima - 2-saddles + 1-saddles - minima must be the Euler
// characteristic of the octree's cells.
struct Audit {
  struct Disagreement {
    Imath::V3d place{0.0};
    std::string what;
  };
  // False when one of the engines left something undecided: then nothing is compared, and `reasons`
  // says what it was.
  bool conclusive = false;
  std::vector<std::string> reasons;
  std::vector<Disagreement> disagreements;      // the first 100
  std::vector<std::uint32_t> component_of_set;  // kNoComponent: none
  std::vector<std::int64_t> euler;              // of each component, from the octree
  double seconds = 0.0;

  bool agreed() const { return conclusive && disagreements.empty(); }
};

Audit audit(const ScalarField& field, const Topology& certified, const MorseComplex& complex,
            const Execution& execution = {});

// Names the sets after the certified components: points' `set` become component ids, `sets` and
// `main` follow, and each component's `maxima` is filled in. Sets without a component keep no name.
void adopt_labels(const Audit& audit, MorseComplex& complex, Topology& topology);

}  // namespace morsel::topology

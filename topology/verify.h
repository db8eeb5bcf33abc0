// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "topology/certified.h"

namespace morsel::topology {

struct VerifyOptions {
  // Leaves to prove again, drawn at random without replacement; each with its six faces. All of
  // them if there are no more, or when `full`.
  std::uint64_t samples = 10000;
  bool full = false;
  std::uint64_t seed = 0;
};

struct VerifyReport {
  std::uint64_t leaves = 0;         // in the octree
  std::uint64_t cells_proved = 0;   // again, of those drawn
  std::uint64_t faces_proved = 0;   // again, of those drawn
  std::uint64_t undecided = 0;      // cells and faces drawn of which the octree claims nothing
  std::uint64_t joins_checked = 0;  // faces between leaves, all of them
  // What is wrong, the first 100; `failure_count` has the number of all.
  std::vector<std::string> failures;
  std::uint64_t failure_count = 0;
  bool passed() const { return failure_count == 0; }
};

// Proves a labelled octree against its field anew. From the octree alone, for all leaves: that
// cells which a face joins are of one component and components are in one piece, that the table's
// cells, volumes and bounds are those of the leaves, that the counts with their bounds, what is
// said to be certified and the list of undecided cells follow. From the field, for the leaves
// drawn: that each cell and face is what the octree says, by single models and the scalar cascade
// (a cell proved empty or full as a whole may need its parts to be looked at). Throws Cancelled.
VerifyReport verify(const ScalarField& field, const Topology& topology,
                    const VerifyOptions& options, const Execution& execution = {});

}  // namespace morsel::topology

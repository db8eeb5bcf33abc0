// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "topology/certified.h"
#include "topology/morse/morse_complex.h"

namespace morsel::topology {

// The two engines against each other. Every critical point must lie in solid, and in the component
// that its set's maxima lie in; sets and components must correspond one to one; and per component
// maxima - 2-saddles + 1-saddles - minima must be the Euler characteristic of the octree's cells
// and of the certified mesh.
struct Audit {
  struct Disagreement {
    Imath::V3d place{0.0};
    std::string what;
  };
  // Where an engine left something undecided, whatever that may explain is not compared, and
  // `reasons` says what was open. What nothing open explains is a disagreement all the same.
  bool conclusive = false;  // nothing was open: all has been compared
  std::vector<std::string> reasons;
  std::vector<Disagreement> disagreements;      // the first 100
  std::vector<std::uint32_t> component_of_set;  // kNoComponent: none
  std::vector<std::int64_t> euler;              // of each component, from the octree; empty: open
  bool mesh_asked = false;                      // AuditOptions: the mesh was made
  bool euler_by_mesh = false;  // and the mesh was certified, hence compared as well
  double perturbation = 0.0;   // of the field that the Morse engine looked at
  double seconds = 0.0;

  bool agreed() const { return conclusive && disagreements.empty(); }
  // "agreed", "disagreed" or "not compared"; the last also where a part of it was.
  std::string verdict() const;
};

struct AuditOptions {
  // Also extract the certified mesh of all components and take Euler characteristics from it: a
  // third witness, which shares no step with the octree's count.
  bool mesh = true;
  // Unless the octree has more leaves than this: a mesh takes about 1.5 kB a leaf while it is made,
  // many times what the octree does.
  std::uint64_t mesh_leaves = 1'000'000;
};

Audit audit(const ScalarField& field, const Topology& certified, const MorseComplex& complex,
            const Execution& execution = {}, const AuditOptions& options = {});

// Names the sets after the certified components: points' `set` become component ids, `sets` and
// `main` follow. When the engines agreed each component's `maxima` is filled in. Sets without a
// component keep no name.
void adopt_labels(const Audit& audit, MorseComplex& complex, Topology& topology);

}  // namespace morsel::topology

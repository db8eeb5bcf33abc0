// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stdexcept>
#include <vector>

#include "topology/certified.h"
#include "topology/morse/critical_point.h"
#include "topology/scalar_field.h"

namespace morsel::topology {

// What to look for.
struct SubdivisionOptions {
  Box box;             // critical points in this closed box
  int max_depth = 24;  // boxes at this depth are not split; what is undecided there is reported
  // More undecided boxes than this: the critical points are not isolated (a ridge, a plateau).
  std::uint64_t max_unresolved = 20000;
  // Points to start from, if any are known (centres of a noise's impulses): see relaxation.h.
  std::vector<Imath::V3d> seeds;
};

// The critical points of F with F > 0, and what could not be decided.
struct CriticalPoints {
  std::vector<CriticalPoint> points;  // by position in the subdivision; no dependence on threads
  std::uint64_t unresolved = 0;       // boxes that may hold a critical point of F > 0
  std::vector<Unresolved> places;     // the first 1000 of them
  std::uint64_t boxes = 0;            // tested
  std::uint64_t models = 0;           // local models evaluated
  std::uint64_t from_seeds = 0;       // points that relaxation of the seeds found

  std::uint64_t count(CriticalType type) const;
};

// The critical points of F form curves or surfaces: no Morse function. A small linear term makes
// it one (see perturbed_field.h).
struct NotIsolated : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Finds every critical point of F in the box where F > 0 (Gamito & Maddock, section 5.1, figure 4),
// with proof: a box is discarded when F < 0 or grad F cannot vanish on it, and is done when the
// Krawczyk operator proves that a slightly larger box holds exactly one zero; everything else is
// split. Points on shared walls are found by several boxes and kept once: two enclosures are of
// one point when one lies in a box that is proved to hold a single zero. Newton's iteration
// (equation 10) then gives the position to 1e-12 of the box's size or to rounding, and the
// enclosure is proved anew around it. Throws NotIsolated, Cancelled, std::invalid_argument.
CriticalPoints find_critical_points(const ScalarField& field, const SubdivisionOptions& options,
                                    const Execution& execution = {});

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "topology/certified.h"
#include "topology/morse/critical_point.h"

namespace morsel::topology {

// One of the two ascents from a 2-saddle along +-v3.
struct Separatrix {
  std::uint32_t saddle = 0;            // index of the critical point it starts from
  std::uint32_t maximum = kNoMaximum;  // and of the one it ends in; kNoMaximum: unresolved
  std::vector<Imath::V3d> path;        // from saddle to maximum; empty unless asked for

  static constexpr std::uint32_t kNoMaximum = 0xffffffffu;
};

// A set S_i of the paper: the maxima of one component of S, and what else lies in that component.
struct MorseSet {
  std::uint64_t maxima = 0, saddles2 = 0, saddles1 = 0, minima = 0;
  std::uint32_t highest = 0;  // index of its highest maximum

  void add(CriticalType type) {
    maxima += type == CriticalType::kMaximum;
    saddles2 += type == CriticalType::kSaddle2;
    saddles1 += type == CriticalType::kSaddle1;
    minima += type == CriticalType::kMinimum;
  }

  // The Euler characteristic of the component, by Morse theory for -F: each maximum begins a piece,
  // a 2-saddle adds a handle, a 1-saddle a membrane, a minimum fills a cavity.
  std::int64_t euler() const {
    return static_cast<std::int64_t>(maxima) - static_cast<std::int64_t>(saddles2) +
           static_cast<std::int64_t>(saddles1) - static_cast<std::int64_t>(minima);
  }
};

// An ascent that ended in no basin.
struct LostStreamline {
  std::uint32_t point = 0;  // index of the critical point that it started from
  Imath::V3d last{0.0};     // where it was given up
  std::string reason;
};

// Critical points of F > 0 in the box, separatrices, and the sets that they join the maxima into.
struct MorseComplex {
  Box box;
  std::vector<CriticalPoint> points;  // by decreasing F
  std::vector<Separatrix> separatrices;
  std::vector<MorseSet> sets;   // by decreasing F of the highest maximum; one per component
  std::uint32_t main = kNoSet;  // the set with most maxima (equation 11); the first of equals

  // What could not be decided. All empty: `sets` is right as far as the ascents are.
  std::uint64_t unresolved_boxes = 0;  // may hold a critical point with F > 0
  std::vector<Unresolved> places;      // the first 1000 of them
  std::vector<LostStreamline> lost;
  // Bounds of the number of sets, whatever the lost ascents of 2-saddles would have joined.
  std::uint64_t sets_lo = 0, sets_hi = 0;

  double perturbation = 0.0;            // as asked for
  std::uint64_t boxes = 0, models = 0;  // work of the subdivision
  double seconds_points = 0.0, seconds_separatrices = 0.0;

  bool resolved() const {
    return unresolved_boxes == 0 && lost.empty() && count(CriticalType::kDegenerate) == 0;
  }
  std::uint64_t count(CriticalType type) const;
};

struct MorseOptions {
  Box box;
  int max_depth = 24;
  bool paths = false;  // keep the separatrices' paths
  // Look at F plus a linear term that is at most this on the box, which makes a field with ridges
  // or plateaus a Morse function (see perturbed_field.h). Values and sets are then of that field.
  double perturbation = 0.0;
};

// The paper's engine: subdivision, separatrices, segmentation. The result does not depend on the
// number of threads. Throws NotIsolated, Cancelled, std::invalid_argument.
MorseComplex morse_complex(const ScalarField& field, const MorseOptions& options,
                           const Execution& execution = {});

}  // namespace morsel::topology

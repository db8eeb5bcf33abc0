// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <string>
#include <vector>

#include "topology/box.h"

namespace morsel::topology {

// One connected component of S, by decreasing volume; the index in the table is its id. Boxes and
// volumes are certified, also where the count is not: of a component that may be one with others,
// or reach into undecided cells, `bounds` and `volume_hi` hold all of these. (The Morse engine's
// table has sums over the cells that it labelled, and proves nothing.)
struct Component {
  Box bounds;                // holds the component
  double volume_lo = 0.0;    // at least: of its full cells
  double volume_hi = 0.0;    // at most: of its full, surface and undecided cells
  std::uint64_t cells = 0;   // decided leaves that hold it
  std::uint64_t maxima = 0;  // 0 when the Morse engine did not run
  // Centre of its largest full cell (then in S), or of a surface cell when it has no full one.
  Imath::V3d seed{0.0};
  double seed_volume = 0.0;  // of that full cell; 0: none
};

// Which components are rendered and meshed (DESIGN: keep rules).
struct KeepRule {
  enum class Kind { kMain, kLargest, kVolume, kTouching, kAll, kDetached, kIds };
  Kind kind = Kind::kMain;
  std::uint64_t count = 1;         // kLargest
  double volume = 0.0;             // kVolume: keep volume_hi >= this
  Imath::V3d point{0.0};           // kTouching
  std::vector<std::uint32_t> ids;  // kIds

  // Parses "main", "largest:K", "volume:V", "touching:X,Y,Z", "all", "detached", "ids:I,J,...".
  // Throws std::invalid_argument that names the text and the choices.
  static KeepRule parse(const std::string& text);
  std::string to_string() const;
};

struct OctreeView;
// The component that is "main": most maxima if any are known, else largest volume. 0 of an empty
// table.
std::uint32_t main_component(const std::vector<Component>& components);
// keep[id] for each component. `touching` keeps the component that the octree's cell at the point
// holds a part of, which is the point's own if the point is in S, and none where that cell is empty
// or the point outside the octree's box.
std::vector<bool> kept_components(const KeepRule& rule, const std::vector<Component>& components,
                                  const OctreeView& octree);

}  // namespace morsel::topology

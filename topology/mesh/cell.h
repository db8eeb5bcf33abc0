// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <array>
#include <cmath>
#include <compare>
#include <cstdint>

#include "topology/box.h"
#include "topology/certified.h"

namespace morsel::topology::meshing {

// A point of the grid of 2^kMaxDepth intervals along each axis of the octree's box; every corner of
// every cell is one.
struct GridPoint {
  std::array<std::uint32_t, 3> at{};
  // NOLINTNEXTLINE(modernize-use-nullptr): there is no pointer.
  auto operator<=>(const GridPoint&) const = default;
};

inline constexpr std::uint32_t kGridSize = 1u << kMaxDepth;
inline constexpr std::uint32_t kNoCell = 0xffffffffu;

// A cell of the octree that holds surface of a kept component.
struct MeshCell {
  GridPoint min;
  std::uint8_t depth = 0;  // level in the octree
  std::uint32_t component = 0;

  std::uint32_t size() const { return kGridSize >> depth; }
  // Corner i is the upper one along x, y, z where bit 0, 1, 2 of i is set.
  GridPoint corner(unsigned i) const {
    GridPoint p = min;
    for (unsigned axis = 0; axis < 3; ++axis) p.at[axis] += ((i >> axis) & 1u) * size();
    return p;
  }
  MeshCell child(unsigned i) const {
    MeshCell c = *this;
    ++c.depth;
    c.min = c.corner(i);
    return c;
  }
};

// The axis and side (-1, 1) of a face of the cell that lies on the boundary of the octree's box;
// side 0: there is none.
struct BoxFace {
  unsigned axis = 0;
  int side = 0;
};
inline BoxFace face_on_box(const MeshCell& cell) {
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (cell.min.at[axis] == 0) return {axis, -1};
    if (cell.min.at[axis] + cell.size() == kGridSize) return {axis, 1};
  }
  return {};
}

// From grid points to object space. Exact for the boxes of labelled octrees (see dyadic_box).
class Grid {
 public:
  explicit Grid(const Box& box) : min_(box.min), unit_((box.max - box.min) / double{kGridSize}) {}

  Imath::V3d point(const GridPoint& p) const {
    return {min_.x + unit_.x * p.at[0], min_.y + unit_.y * p.at[1], min_.z + unit_.z * p.at[2]};
  }
  Box box(const MeshCell& c) const { return {point(c.corner(0)), point(c.corner(7))}; }
  // The cell of `depth` levels that has the box `box`.
  MeshCell cell(const Box& box, int depth) const {
    MeshCell c;
    c.depth = static_cast<std::uint8_t>(depth);
    for (unsigned axis = 0; axis < 3; ++axis)
      c.min.at[axis] = static_cast<std::uint32_t>(
          std::llround((box.min[static_cast<int>(axis)] - min_[static_cast<int>(axis)]) /
                       unit_[static_cast<int>(axis)]));
    return c;
  }

 private:
  Imath::V3d min_, unit_;
};

inline Box inflated(const Box& box, double by) {
  return {box.min - Imath::V3d(by), box.max + Imath::V3d(by)};
}
// The shortest side.
inline double shortest_side(const Box& box) {
  const Imath::V3d s = box.max - box.min;
  return std::min(s.x, std::min(s.y, s.z));
}

}  // namespace morsel::topology::meshing

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>

#include "hypertexture_geom/field/curvature.h"
#include "topology/octree.h"

namespace morsel::geom {

// What a renderer needs to know of every hit, in object space.
//
// The scheme of positions: a hit's point comes to shading rounded to float, so it may lie on either
// side of the surface. From it two floating-point positions are sought along the normal, one in
// front and one behind, at twice the bound on the point's error, until F has the right sign there
// *by evaluation*. In a gap or a sheet thinner than that nearer points are tried, and where the
// bound proves too small ones that are farther, as long as F is proved to change in one direction
// all the way: a spawn point never lies behind another solid or gap that coordinates can tell. A
// ray from such a point need no epsilon: its tnear can be 0. Between both points F changes its
// sign, so the surface passes between them, which bounds the error of any position near them.
struct ShadingPoint {
  Imath::V3f normal;  // unit, outward (-grad F), from the exact gradient
  // Origins for rays that leave to the outside (F < 0 there, by evaluation) and to the inside (F >
  // 0 there, by evaluation). Where a sheet is too thin for that, the best point tried: check the
  // flag.
  Imath::V3f spawn_front;
  Imath::V3f spawn_behind;
  bool spawn_verified = false;  // both signs are as said
  std::uint32_t component = topology::kNoComponent;
  // The hit's point taken to F = 0 by one Newton step along the gradient, of at most the bound on
  // the point's error. The surface lies within `position_error` of it if spawn_verified: both spawn
  // points do, and the surface is between them. Otherwise that is the distance of the farther one.
  Imath::V3d position{0.0};
  double position_error = 0.0;
};

// What a material may want beside that; dearer, so asked for on its own.
struct SurfaceDetail {
  std::uint32_t component = topology::kNoComponent;
  double density = 0.0;       // D before any modulation
  double noise = 0.0;         // F - D: the sum of what modulations did
  Imath::V3d reference{0.0};  // the point before domain warps: for textures that move with them
  Imath::V3d gradient{0.0};   // of F
  Curvature curvature;        // of the level set of F through the point
};

}  // namespace morsel::geom

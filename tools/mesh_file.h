// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "topology/mesh/mesh.h"

namespace morsel::tools {

// All formats hold per vertex: position, normal, component (its id in the table of components).
// `error` is what the file may be from the surface: positions are stored so that their rounding is
// at most a hundredth of it. All return a bound on how far rounding has moved a point of the mesh.

// Binary little-endian PLY: float (double where float is too coarse, or would make vertices of a
// triangle coincide) x y z, float nx ny nz, uint
// component; faces as lists of uint. Throws std::runtime_error when a count exceeds the format's.
double write_ply(std::ostream& out, const topology::Mesh& mesh, double error);

// Binary glTF 2.0, one primitive: POSITION and NORMAL as float, _COMPONENT as float (glTF allows no
// 32-bit integers there), indices as uint. Positions are relative to the node's translation, which
// is zero unless float is too coarse far from the origin; then the middle of the mesh. Throws
// std::runtime_error when float is too coarse even so, and beyond 4 GiB, the format's limit.
double write_glb(std::ostream& out, const topology::Mesh& mesh, double error);

// Wavefront OBJ: v, vn, and f with both; the triangles of component N are the group component_N.
// Numbers have as many digits as tell floats apart, or doubles where write_ply has these.
double write_obj(std::ostream& out, const topology::Mesh& mesh, double error);

}  // namespace morsel::tools

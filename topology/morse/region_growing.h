// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "topology/certified.h"
#include "topology/scalar_field.h"

namespace morsel::topology {

// The two simple ways of section 3 of the paper, for comparison. Both sample F at the (n + 1)^3
// corners of n^3 voxels of the box and neither is right but by luck: a gap between two pieces that
// no corner falls into is not seen, nor is a piece between the corners.
struct RegionCount {
  std::uint64_t components = 0;
  std::uint64_t elements = 0;     // voxels that hold solid; triangles
  std::uint64_t evaluations = 0;  // of F; blocks of samples that a local model decides need none
  double seconds = 0.0;
};

inline constexpr int kMaxGridResolution = 4096;

// Voxel region growing: a voxel belongs to the solid when one of its corners does; voxels of the
// solid that share a face belong together. Throws Cancelled, std::invalid_argument unless 2 <= n <=
// kMaxGridResolution.
RegionCount grow_voxel_regions(const ScalarField& field, const Box& box, int n,
                               const Execution& execution = {});

// Region growing over a polygonal mesh (marching tetrahedra: each voxel is cut into six about its
// diagonal): triangles that share a vertex belong together. Counts surfaces: a cavity is one more.
// Throws as above.
RegionCount grow_mesh_regions(const ScalarField& field, const Box& box, int n,
                              const Execution& execution = {});

}  // namespace morsel::topology

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/field/field.h"
#include "topology/certified.h"

namespace morsel::tools {

// What certified labels cost, against the least that sampling the field costs.
struct TopologyBench {
  double label_seconds = 0.0;      // octree, joins, component table
  double evaluate_seconds = 0.0;   // F once at every voxel's centre
  int resolution = 0;              // voxels along each axis of the box
  std::uint64_t positive = 0;      // voxels with F >= 0: shows that they were evaluated
  std::uint64_t packed_bytes = 0;  // of the octree in a cache file
  topology::Topology topology;
  double ratio() const { return label_seconds / evaluate_seconds; }
};

// Labels the geometry, then evaluates its field at resolution^3 points with the fastest evaluator
// there is (CompiledField<float>, blocks of voxels in parallel), both in the caller's TBB arena.
// Throws topology::Cancelled.
TopologyBench bench_topology(const geom::Hypertexture& hypertexture, int resolution,
                             const topology::Execution& execution);

}  // namespace morsel::tools

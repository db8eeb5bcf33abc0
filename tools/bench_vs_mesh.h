// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "hypertexture_geom/field/field.h"
#include "tools/reporter.h"
#include "topology/certified.h"

namespace morsel::tools {

struct VsMeshOptions {
  double error = 1e-4;  // of the mesh, as a share of the diagonal of what is kept
  int side = 1024;      // of the image whose primary rays are traced
  int repetitions = 5;  // of each measurement, the two surfaces in turn
};

// A hypertexture geometry against Embree triangles of `morsel mesh`: a JSON object with `vs_mesh`
// and `evaluations_per_ray`. See tools/README.md for what each number is.
nlohmann::json bench_vs_mesh(const geom::Hypertexture& hypertexture, const VsMeshOptions& options,
                             const topology::Execution& execution, Reporter& reporter);

}  // namespace morsel::tools

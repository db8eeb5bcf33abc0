// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hypertexture_geom/field/field.h"
#include "tools/reporter.h"
#include "topology/certified.h"

namespace morsel::tools {

// Ways to count components: "certified", "morse", and region growing over "voxel"s or a polygonal
// "mesh", which nothing proves.
struct EngineChoice {
  std::vector<std::string> engines{"certified", "morse", "voxel", "mesh"};
  std::vector<int> resolutions;  // voxels along each side of the box, for voxel and mesh
};

// A row for each engine (and resolution): {engine, components, certified, seconds, ...}. `each` is
// given every row as it comes, with what there is to say of its certification, and may be empty.
// Warns where the box cuts the solid. Throws topology::Cancelled.
nlohmann::json count_by_engines(
    const geom::Hypertexture& hypertexture, const EngineChoice& choice,
    topology::Execution execution, Reporter& reporter,
    const std::function<void(const nlohmann::json& row, const std::string& certified)>& each = {});

}  // namespace morsel::tools

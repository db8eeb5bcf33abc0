// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "renderer/scene/load_scene.h"
#include "tools/bench_small_render.h"
#include "tools/reporter.h"
#include "topology/certified.h"

namespace morsel::tools {

// The same render by 1, 2, 4, ... threads and all of the processor's, in turn: a list of {threads,
// samples_per_second (median), spread, speedup}.
nlohmann::json bench_scaling(const render::LoadedScene& loaded, const SmallRender& small,
                             const topology::Execution& execution, Reporter& reporter);

// The scene with 1, 2, ... `most` layers in the first modulation of a hypertexture: a list of
// {layers, label_seconds, components, certified, bricks, samples_per_second, evaluations_per_ray
// (of camera rays)}. Caches are temporary files.
nlohmann::json bench_layers(const std::string& scene,
                            const std::vector<render::Override>& overrides,
                            const std::string& geometry, int most, const SmallRender& small,
                            const topology::Execution& execution, Reporter& reporter);

}  // namespace morsel::tools

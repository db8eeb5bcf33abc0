// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "renderer/scene/load_scene.h"
#include "renderer/scene/scene_json.h"
#include "tools/bench_page.h"
#include "tools/bench_small_render.h"
#include "tools/reporter.h"

namespace morsel::tools {

// NOLINTNEXTLINE(bugprone-exception-escape): moving JSON throws nothing.
struct MixedBench {
  nlohmann::json result;
  std::vector<BenchPicture> pictures;  // the scene with hypertextures, and with meshes
};

// The scene's render as it is against the same scene of meshes alone, in which each hypertexture
// that is used is replaced by the triangles of what is kept of it, within `error` of its diagonal;
// in turn, samples per second of tracing. `result`: {ratio, spread, samples_per_second: {mixed,
// mesh}, mean_luminance: {mixed, mesh}, hypertextures, triangles, relative_error}.
MixedBench bench_mixed(const render::SceneDocument& document, const render::LoadedScene& loaded,
                       double error, const SmallRender& small, const topology::Execution& execution,
                       Reporter& reporter);

}  // namespace morsel::tools

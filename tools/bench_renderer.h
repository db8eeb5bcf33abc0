// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "renderer/scene/load_scene.h"
#include "tools/bench_small_render.h"
#include "tools/reporter.h"

namespace morsel::tools {

// What of the time of a render is rays: the scene is rendered small (see make_small), its rays are
// written down and traced again by calls of Embree and nothing else. Returns `efficiency`, the time
// of those calls / the time of the render, its spread over the repetitions and what it is made of.
// Processor time; building the scene is in neither.
nlohmann::json bench_renderer(const render::LoadedScene& loaded, const SmallRender& small,
                              Reporter& reporter);

}  // namespace morsel::tools

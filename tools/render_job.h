// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <nlohmann/json.hpp>

#include "renderer/scene/load_scene.h"
#include "tools/render_options.h"
#include "tools/reporter.h"

namespace morsel::tools {

// NOLINTNEXTLINE(bugprone-exception-escape): moving JSON throws nothing.
struct RenderedScene {
  nlohmann::json statistics;                 // see statistics_json(); null unless they are wanted
  std::vector<std::filesystem::path> files;  // pictures that were written
  bool interrupted = false;  // before all samples were there: the pictures are partial
};

// Only the scene, with the plan's overrides and crop.
render::LoadedScene load_for_render(const RenderPlan& plan, Reporter& reporter,
                                    const std::atomic<bool>& cancel);

// Loads a scene, renders it as planned and writes the pictures, also partial ones when `cancel`
// becomes true. Throws topology::Cancelled when that happens before the first sample, and what
// loading, rendering and writing throw.
RenderedScene render_scene(const RenderPlan& plan, bool with_statistics, Reporter& reporter,
                           const std::atomic<bool>& cancel);

}  // namespace morsel::tools

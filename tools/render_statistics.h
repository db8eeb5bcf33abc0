// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "renderer/integrator/render.h"
#include "renderer/scene/load_scene.h"
#include "tools/render_options.h"

namespace morsel::tools {

// What a render was and took, for `--stats`.
struct RenderReport {
  double load_seconds = 0, render_seconds = 0, write_seconds = 0;
  double processor_seconds = 0;  // of all threads, while rendering
  int threads = 1;
};

// Ray tests that ended at the limit of field evaluations, so that a hit may be missing or not the
// first one: 0 unless a field is degenerate.
std::uint64_t step_limits(const render::Scene& scene);

// See STATISTICS.md.
nlohmann::json statistics_json(const RenderReport& report, const RenderPlan& plan,
                               const render::LoadedScene& loaded,
                               const render::RenderResult& result);

// The same for people, with line ends.
std::string statistics_text(const nlohmann::json& statistics);

}  // namespace morsel::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "renderer/integrator/render.h"
#include "renderer/scene/load_scene.h"

namespace morsel::tools {

// What a render was and took, for `--stats`.
struct RenderReport {
  std::string scene, exr, png;  // png: empty if none was written
  double load_seconds = 0, render_seconds = 0, write_seconds = 0;
};
// Ray tests that ended at the limit of field evaluations, so that a hit may be missing or not the
// first one: 0 unless a field is degenerate.
std::uint64_t step_limits(const render::Scene& scene);

nlohmann::json statistics_json(const RenderReport& report, const render::LoadedScene& loaded,
                               const render::RenderResult& result);

// The same for people, with line ends.
std::string statistics_text(const nlohmann::json& statistics);

}  // namespace morsel::tools

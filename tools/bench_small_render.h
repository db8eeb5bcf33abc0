// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/integrator/render.h"
#include "topology/certified.h"

namespace morsel::tools {

// A small render whose cost is looked at as something changes.
struct SmallRender {
  int width = 320, spp = 4, repetitions = 3;
};

// Sets the scene to at most `small.width` pixels a row, the same shape of picture, without a crop.
void make_small(render::Scene& scene, const SmallRender& small);

// `threads` as in render::RenderOptions. Throws topology::Cancelled.
render::RenderResult render_once(const render::Scene& scene, int threads,
                                 const topology::Execution& execution);

// Of tracing alone, by the clock: building the scene is left out.
double samples_per_second(const render::RenderStatistics& statistics);

}  // namespace morsel::tools

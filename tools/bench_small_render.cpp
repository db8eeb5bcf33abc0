// SPDX-License-Identifier: Apache-2.0
#include "tools/bench_small_render.h"

#include <algorithm>

namespace morsel::tools {

void make_small(render::Scene& scene, const SmallRender& small) {
  render::RenderSettings& settings = scene.settings;
  if (settings.width > small.width) {
    settings.height = std::max(1, settings.height * small.width / settings.width);
    settings.width = small.width;
  }
  settings.spp = small.spp;
  settings.crop.reset();
}

render::RenderResult render_once(const render::Scene& scene, int threads,
                                 const topology::Execution& execution) {
  render::RenderOptions options;
  options.threads = threads;
  options.cancel = execution.cancel;
  render::RenderResult result = render::render(scene, options);
  if (result.cancelled()) throw topology::Cancelled();
  return result;
}

double samples_per_second(const render::RenderStatistics& statistics) {
  return static_cast<double>(statistics.samples) / std::max(statistics.seconds_of("trace"), 1e-9);
}

}  // namespace morsel::tools

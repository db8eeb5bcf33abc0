// SPDX-License-Identifier: Apache-2.0
#include "tools/bench_renderer.h"

#include <algorithm>
#include <vector>

#include "renderer/accel/ray_log.h"
#include "renderer/accel/scene_accel.h"
#include "renderer/integrator/render.h"
#include "renderer/light/light_set.h"
#include "renderer/material/material_set.h"
#include "tools/bench_numbers.h"
#include "tools/bench_rays.h"

namespace morsel::tools {

nlohmann::json bench_renderer(const render::LoadedScene& loaded, const SmallRender& small,
                              Reporter& reporter) {
  render::Scene scene = loaded.scene;
  make_small(scene, small);

  reporter.info("recording the rays of a render");
  render::RayLog log;
  render::render(scene);
  log.stop();

  std::vector<double> efficiency, render_seconds, replay_seconds;
  for (int i = 0; i < small.repetitions; ++i) {
    reporter.info("rendering, and replaying its rays");
    double start = processor_seconds();
    {
      const render::SceneAccel accel(scene);
      const render::MaterialSet materials(scene);
      const render::LightSet lights(scene, false);
    }
    const double build = processor_seconds() - start;
    start = processor_seconds();
    render::render(scene);
    render_seconds.push_back(processor_seconds() - start - build);
    start = processor_seconds();
    log.replay();
    replay_seconds.push_back(processor_seconds() - start);
    efficiency.push_back(replay_seconds.back() / render_seconds.back());
  }
  return {{"efficiency", median(efficiency)},
          {"spread", spread(efficiency)},
          {"rays", log.size()},
          {"width", scene.settings.width},
          {"height", scene.settings.height},
          {"spp", small.spp},
          {"render_seconds", *std::min_element(render_seconds.begin(), render_seconds.end())},
          {"replay_seconds", *std::min_element(replay_seconds.begin(), replay_seconds.end())}};
}

}  // namespace morsel::tools

// SPDX-License-Identifier: Apache-2.0
#include "tools/debug_pixel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "renderer/integrator/trace_pixel.h"
#include "tools/parse_values.h"
#include "tools/render_job.h"
#include "tools/session.h"

namespace morsel::tools {
namespace {

std::string shown(const Imath::V3f& v) {
  return fmt::format("{:.7g} {:.7g} {:.7g}", v.x, v.y, v.z);
}

std::string name_of(const render::Scene& scene, std::uint32_t instance) {
  return instance < scene.instances.size() ? scene.instances[instance].name : "a light";
}

// "hits rock at t = 4.2"; a shadow ray is "blocked by rock at t = 0.3" or reaches its light.
std::string fate(const render::Scene& scene, const render::TracedRay& r) {
  const bool shadow = r.query == render::RayLog::Query::kOccluded;
  if (!r.met) {
    if (!shadow) return "hits nothing";
    return std::isfinite(r.ray.tfar) ? "reaches its light" : "reaches light from afar";
  }
  return fmt::format("{} {} at t = {:.7g}", shadow ? "is blocked by" : "hits",
                     name_of(scene, r.met->instance), r.met->t);
}

void print(const render::Scene& scene, bool halves, const render::TracedSample& traced) {
  const render::PathSample& s = traced.sample;
  std::cout << fmt::format("sample {}{}: at {:.4f},{:.4f}, radiance {}, alpha {:g}\n", traced.index,
                           halves ? fmt::format(" of half {}", traced.half) : "", traced.film.x,
                           traced.film.y, shown(s.radiance), s.alpha);
  if (s.depth < render::kFarDepth) {
    std::cout << fmt::format(
        "  hits {} ({}) at {}, depth {:.7g}, normal {}, albedo {}", name_of(scene, s.instance),
        s.material < scene.materials.size() ? scene.materials[s.material].name : "no material",
        shown(s.position), s.depth, shown(s.geometric_normal), shown(s.albedo));
    if (s.component > 0.0f) std::cout << fmt::format(", component {:.0f}", s.component - 1.0f);
    std::cout << '\n';
  }
  for (const render::TracedRay& r : traced.rays) {
    const char* kind = r.query == render::RayLog::Query::kCoherent   ? "camera"
                       : r.query == render::RayLog::Query::kOccluded ? "shadow"
                                                                     : "bounce";
    std::cout << fmt::format("  {} ray from {} towards {}, to t = {:.7g}, {}\n", kind,
                             shown({r.ray.org_x, r.ray.org_y, r.ray.org_z}),
                             shown({r.ray.dir_x, r.ray.dir_y, r.ray.dir_z}), r.ray.tfar,
                             fate(scene, r));
  }
}

}  // namespace

int debug_pixel(const std::string& scene, const std::vector<render::Override>& overrides,
                const std::string& pixel, Reporter& reporter, const std::atomic<bool>& cancel) {
  const std::vector<int> at = parse_integers("--debug-pixel", pixel, ',', 2, "x,y in pixels");
  RenderPlan plan;
  plan.scene = scene;
  plan.overrides = overrides;
  const render::LoadedScene loaded = load_for_render(plan, reporter, cancel);
  const render::RenderSettings& settings = loaded.scene.settings;
  if (at[0] < 0 || at[1] < 0 || at[0] >= settings.width || at[1] >= settings.height)
    throw UsageError(fmt::format("--debug-pixel {}: the picture has {} x {} pixels", pixel,
                                 settings.width, settings.height));
  const render::TracedPixel traced = render::trace_pixel(loaded.scene, at[0], at[1]);
  const auto& samples = traced.samples;
  const bool halves = std::any_of(samples.begin(), samples.end(),
                                  [](const render::TracedSample& s) { return s.half > 0; });
  for (const render::TracedSample& sample : samples) print(loaded.scene, halves, sample);
  std::cout << fmt::format("mean of {} samples{}: {}\n", samples.size(),
                           halves ? ", of the halves' means" : "", shown(traced.pixel.color));
  return kDone;
}

}  // namespace morsel::tools

// SPDX-License-Identifier: Apache-2.0
#include "tools/debug_pixel.h"

#include <fmt/format.h>

#include <algorithm>
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

bool asks_for_cutouts(const render::TracedRay& r) {
  return r.ray.mask == static_cast<unsigned>(render::RayKind::kCutout);
}

const char* kind_of(const render::TracedRay& r) {
  if (r.query == render::RayLog::Query::kCoherent) return "camera";
  if (r.query == render::RayLog::Query::kOccluded) return "shadow";
  return asks_for_cutouts(r) ? "cut-out" : "bounce";
}

// "hits rock at a distance of 4.2". A shadow ray is "blocked by" what does so; if it is not, rays
// for what it may pass in part follow in scenes that have such things, and the last of all that
// nothing is in the way of reaches the light.
std::string fate(const render::Scene& scene, const render::TracedRay& r, bool more) {
  const bool shadow = r.query == render::RayLog::Query::kOccluded;
  if (r.met) {
    const Imath::V3f direction(r.ray.dir_x, r.ray.dir_y, r.ray.dir_z);
    return fmt::format("{} {} at a distance of {:.7g}", shadow ? "is blocked by" : "hits",
                       name_of(scene, r.met->instance), r.met->t * direction.length());
  }
  if (shadow && more) return "meets nothing solid";
  return shadow || asks_for_cutouts(r) ? "reaches its light" : "hits nothing";
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
  for (std::size_t i = 0; i < traced.rays.size(); ++i) {
    const render::TracedRay& r = traced.rays[i];
    const bool more = i + 1 < traced.rays.size() && asks_for_cutouts(traced.rays[i + 1]);
    std::cout << fmt::format("  {} ray from {} towards {}, to t = {:.7g}, {}\n", kind_of(r),
                             shown({r.ray.org_x, r.ray.org_y, r.ray.org_z}),
                             shown({r.ray.dir_x, r.ray.dir_y, r.ray.dir_z}), r.ray.tfar,
                             fate(scene, r, more));
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

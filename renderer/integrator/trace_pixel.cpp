// SPDX-License-Identifier: Apache-2.0
#include "renderer/integrator/trace_pixel.h"

#include <fmt/format.h>

#include <stdexcept>

#include "renderer/film/pixel_filter.h"
#include "renderer/integrator/path_tracer.h"

namespace morsel::render {

std::vector<TracedSample> trace_pixel(const Scene& scene, int x, int y) {
  const RenderSettings& settings = scene.settings;
  if (x < 0 || y < 0 || x >= settings.width || y >= settings.height)
    throw std::invalid_argument(fmt::format("pixel {},{} is not in the image of {} x {} pixels", x,
                                            y, settings.width, settings.height));
  const Camera camera(scene.camera, settings.width, settings.height);
  const SceneAccel accel(scene);
  const MaterialSet materials(scene);
  const LightSet lights(scene, false);
  const PathTracer tracer(scene, accel, materials, lights, camera, DirectLighting::kMis);
  const FilterSampler filter(settings.filter, settings.filter_radius);
  const FlushDenormals flush;

  std::vector<TracedSample> samples;
  PixelSampler sampler(x, y, settings.seed);
  RayLog log;
  RayCounts rays;
  for (int i = 0; i < settings.spp; ++i) {
    sampler.start_sample(static_cast<std::uint32_t>(i));
    const std::size_t before = log.own_records().size();
    TracedSample traced;
    traced.film = V2f(static_cast<float>(x), static_cast<float>(y)) + V2f(0.5f) +
                  filter.sample(sampler.get_2d(kPixelDimension));
    const Ray ray = camera_ray(camera, sampler, traced.film);
    traced.sample = tracer.trace(ray, sampler, rays);
    const auto& records = log.own_records();
    traced.rays.assign(records.begin() + static_cast<std::ptrdiff_t>(before), records.end());
    samples.push_back(std::move(traced));
  }
  return samples;
}

}  // namespace morsel::render

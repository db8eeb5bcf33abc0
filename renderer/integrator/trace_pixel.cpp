// SPDX-License-Identifier: Apache-2.0
#include "renderer/integrator/trace_pixel.h"

#include <fmt/format.h>

#include <stdexcept>

#include "renderer/film/film_sums.h"
#include "renderer/integrator/path_tracer.h"
#include "renderer/integrator/pixel_renderer.h"

namespace morsel::render {
namespace {

// Asks again, without a log.
void find_what_was_met(const SceneAccel& accel, TracedRay& traced) {
  const RTCRay& r = traced.ray;
  Ray ray;
  ray.origin = {r.org_x, r.org_y, r.org_z};
  ray.direction = {r.dir_x, r.dir_y, r.dir_z};
  ray.tfar = r.tfar;
  ray.time = r.time;
  SurfaceInteraction met;
  if (accel.intersect(ray, static_cast<RayKind>(r.mask), met)) traced.met = met;
}

}  // namespace

TracedPixel trace_pixel(const Scene& scene, int x, int y) {
  RenderSettings settings = scene.settings;
  if (x < 0 || y < 0 || x >= settings.width || y >= settings.height)
    throw std::invalid_argument(fmt::format("pixel {},{} is not in the image of {} x {} pixels", x,
                                            y, settings.width, settings.height));
  settings.crop = Crop{x, y, x + 1, y + 1};
  settings.cryptomatte = false;
  const Camera camera(scene.camera, settings.width, settings.height);
  const SceneAccel accel(scene);
  const MaterialSet materials(scene);
  const LightSet lights(scene, false);
  const PathTracer tracer(scene, accel, materials, lights, camera, DirectLighting::kMis);
  const FlushDenormals flush;

  TracedPixel traced;
  RayLog log;
  std::size_t seen = 0;
  const PixelRenderer::Watch watch = [&](std::uint32_t half, std::uint32_t index, const V2f& film,
                                         const PathSample& sample) {
    const auto& records = log.own_records();
    traced.samples.push_back({half, index, film, sample, {}});
    for (; seen < records.size(); ++seen)
      traced.samples.back().rays.push_back({records[seen].ray, records[seen].query, {}});
  };
  NonFiniteReport non_finite(false);
  const PixelRenderer pixels(tracer, camera, settings, nullptr, {}, non_finite, &watch);
  FilmSums sums(FilmLayout(settings, scene.light_groups.size()));
  sums.with_tile(0, [&](TileSums& tile) { pixels.advance(x, y, pixels.most_samples(), tile); });
  traced.pixel = sums.develop().at(x, y);
  log.stop();
  for (TracedSample& sample : traced.samples)
    for (TracedRay& ray : sample.rays) find_what_was_met(accel, ray);
  return traced;
}

}  // namespace morsel::render

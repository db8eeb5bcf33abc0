// SPDX-License-Identifier: Apache-2.0
#include "renderer/integrator/render.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <mutex>
#include <stdexcept>

#include "renderer/integrator/pixel_renderer.h"

namespace morsel::render {
namespace {

constexpr int kTileSize = 32;

class Stopwatch {
 public:
  double restart() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    start_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

class TileRenderer {
 public:
  TileRenderer(const PixelRenderer& pixels, const RenderOptions& options, RenderResult& result)
      : pixels_(pixels),
        options_(options),
        result_(result),
        columns_((result.film.width() + kTileSize - 1) / kTileSize),
        rows_((result.film.height() + kTileSize - 1) / kTileSize) {}

  int count() const { return columns_ * rows_; }

  void render(int tile) {
    const Crop& window = result_.film.window();
    const int x0 = window.x0 + (tile % columns_) * kTileSize;
    const int y0 = window.y0 + (tile / columns_) * kTileSize;
    const int x1 = std::min(x0 + kTileSize, window.x1), y1 = std::min(y0 + kTileSize, window.y1);
    TileCounts counts;
    bool complete = true;
    {
      const FlushDenormals flush;
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
          complete = complete && !stopped();
          if (!complete) break;
          pixels_.render(x, y, result_.film, counts);
        }
    }
    finish(counts, complete);
  }

 private:
  bool stopped() const {
    return options_.cancel != nullptr && options_.cancel->load(std::memory_order_relaxed);
  }

  void finish(const TileCounts& counts, bool complete) {
    const std::lock_guard lock(mutex_);
    RenderStatistics& s = result_.statistics;
    s.rays.camera += counts.rays.camera;
    s.rays.bounce += counts.rays.bounce;
    s.rays.shadow += counts.rays.shadow;
    s.samples += counts.samples;
    s.non_finite_samples += counts.non_finite;
    s.firefly_pixels += counts.fireflies;
    s.brightest_sample = std::max(s.brightest_sample, counts.brightest);
    result_.film.add_components(counts.components);
    if (!complete) {
      result_.cancelled = true;
      return;
    }
    ++finished_;
    if (options_.progress) options_.progress(static_cast<double>(finished_) / count());
  }

  const PixelRenderer& pixels_;
  const RenderOptions& options_;
  RenderResult& result_;
  int columns_, rows_;
  int finished_ = 0;
  std::mutex mutex_;
};

}  // namespace

double RenderStatistics::seconds_of(const std::string& phase) const {
  for (const auto& [name, value] : seconds)
    if (name == phase) return value;
  return 0.0;
}

RenderResult render(const Scene& scene, const RenderOptions& options) {
  const RenderSettings& settings = scene.settings;
  if (settings.spp < 1)
    throw std::invalid_argument(fmt::format("render: {} samples per pixel", settings.spp));
  if (settings.max_depth < 0)
    throw std::invalid_argument(fmt::format("render: max_depth is {}", settings.max_depth));
  if (options.threads < 0)
    throw std::invalid_argument(fmt::format("render: {} threads", options.threads));

  RenderResult result{
      .film = Film(settings, scene.light_groups.size()), .statistics = {}, .cancelled = false};
  const Camera camera(scene.camera, settings.width, settings.height);
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    RenderStatistics& statistics = result.statistics;
    Stopwatch watch;
    const SceneAccel accel(scene);
    statistics.accel = accel.statistics();
    statistics.seconds.emplace_back("build", watch.restart());
    const MaterialSet materials(scene);
    statistics.seconds.emplace_back("materials", watch.restart());
    const LightSet lights(scene, options.direct_lighting == DirectLighting::kLightsOnly);
    statistics.seconds.emplace_back("lights", watch.restart());

    const PathTracer tracer(scene, accel, materials, lights, camera, options.direct_lighting);
    const MatteNames names(scene);
    const PixelRenderer pixels(tracer, camera, settings, settings.cryptomatte ? &names : nullptr);
    TileRenderer tiles(pixels, options, result);
    tbb::parallel_for(
        tbb::blocked_range<int>(0, tiles.count(), 1),
        [&](const tbb::blocked_range<int>& range) {
          for (int i = range.begin(); i < range.end(); ++i) tiles.render(i);
        },
        tbb::simple_partitioner());
    statistics.seconds.emplace_back("trace", watch.restart());
    statistics.textures = materials.texture_statistics();
  });
  return result;
}

}  // namespace morsel::render

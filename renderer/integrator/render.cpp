// SPDX-License-Identifier: Apache-2.0
#include "renderer/integrator/render.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <mutex>
#include <stdexcept>

#include "renderer/integrator/path_tracer.h"

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

// Work that tiles do on their own and hand in at their end.
struct TileCounts {
  RayCounts rays;
  std::uint64_t samples = 0, non_finite = 0;
};

Pixel render_pixel(const PathTracer& tracer, const RenderSettings& settings, int x, int y,
                   TileCounts& counts) {
  PixelSampler sampler(x, y, settings.seed);
  PixelAccumulator pixel;
  for (int i = 0; i < settings.spp; ++i) {
    sampler.start_sample(static_cast<std::uint32_t>(i));
    const V2f offset = sampler.get_2d(kPixelDimension);
    PathSample sample = tracer.trace(static_cast<float>(x) + offset.x,
                                     static_cast<float>(y) + offset.y, sampler, counts.rays);
    ++counts.samples;
    if (!is_finite(sample.radiance)) {
      ++counts.non_finite;
      sample.radiance = V3f(0.0f);
    }
    pixel.add(sample, offset.x, offset.y);
  }
  return pixel.result();
}

class TileRenderer {
 public:
  TileRenderer(const PathTracer& tracer, const RenderSettings& settings,
               const RenderOptions& options, RenderResult& result)
      : tracer_(tracer),
        settings_(settings),
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
          result_.film.at(x, y) = render_pixel(tracer_, settings_, x, y, counts);
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
    if (!complete) {
      result_.cancelled = true;
      return;
    }
    ++finished_;
    if (options_.progress) options_.progress(static_cast<double>(finished_) / count());
  }

  const PathTracer& tracer_;
  const RenderSettings& settings_;
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

  RenderResult result{.film = Film(settings), .statistics = {}, .cancelled = false};
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
    TileRenderer tiles(tracer, settings, options, result);
    tbb::parallel_for(
        tbb::blocked_range<int>(0, tiles.count(), 1),
        [&](const tbb::blocked_range<int>& range) {
          for (int i = range.begin(); i < range.end(); ++i) tiles.render(i);
        },
        tbb::simple_partitioner());
    statistics.seconds.emplace_back("trace", watch.restart());
  });
  return result;
}

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#include "renderer/integrator/render.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <vector>

#include "renderer/integrator/pass_schedule.h"
#include "renderer/integrator/pixel_renderer.h"

namespace morsel::render {
namespace {

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

// Hands out tiles pass by pass. Threads that are ahead begin the next pass while others are still
// in this one; the tile's lock keeps two passes of one tile apart, and their order does not matter.
class PassQueue {
 public:
  PassQueue(std::vector<std::uint32_t> targets, int tiles)
      : targets_(std::move(targets)), tiles_(static_cast<std::uint64_t>(tiles)) {}

  struct Item {
    int tile;
    std::uint64_t pass;
    std::uint32_t target;
    double share;  // of all work
  };
  std::optional<Item> next() {
    const std::uint64_t i = next_.fetch_add(1, std::memory_order_relaxed);
    const std::uint64_t pass = i / tiles_;
    if (pass >= targets_.size()) return std::nullopt;
    const std::uint32_t before = pass == 0 ? 0 : targets_[pass - 1];
    return Item{static_cast<int>(i % tiles_), pass, targets_[pass],
                static_cast<double>(targets_[pass] - before) /
                    (static_cast<double>(targets_.back()) * static_cast<double>(tiles_))};
  }
  std::uint64_t size() const { return targets_.size() * tiles_; }

 private:
  std::vector<std::uint32_t> targets_;
  std::uint64_t tiles_;
  std::atomic<std::uint64_t> next_{0};
};

class TileRenderer {
 public:
  TileRenderer(const PixelRenderer& pixels, const RenderOptions& options, FilmSums& sums)
      : pixels_(pixels),
        options_(options),
        sums_(sums),
        queue_(pass_schedule(pixels.first_target(), pixels.most_samples()), sums.tile_count()) {}

  // To be called by every thread that takes part.
  void work() {
    const FlushDenormals flush;
    while (const auto item = queue_.next()) {
      if (!render(*item)) return;
      finish(*item);
    }
  }

  RenderEnd end() const {
    if (cancelled_) return RenderEnd::kCancelled;
    return late_ ? RenderEnd::kDeadline : RenderEnd::kDone;
  }

 private:
  bool render(const PassQueue::Item& item) {
    return sums_.with_tile(item.tile, [&](TileSums& tile) {
      const Crop& w = tile.window;
      for (int y = w.y0; y < w.y1; ++y)
        for (int x = w.x0; x < w.x1; ++x) {
          if (stopped(item)) return false;
          pixels_.advance(x, y, item.target, tile);
        }
      return true;
    });
  }

  bool stopped(const PassQueue::Item& item) {
    if (options_.cancel != nullptr && options_.cancel->load(std::memory_order_relaxed))
      cancelled_.store(true, std::memory_order_relaxed);
    if (options_.time_limit && item.pass > 0 && elapsed() >= *options_.time_limit)
      late_.store(true, std::memory_order_relaxed);
    return cancelled_.load(std::memory_order_relaxed) ||
           (item.pass > 0 && late_.load(std::memory_order_relaxed));
  }

  double elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

  void finish(const PassQueue::Item& item) {
    const std::lock_guard lock(mutex_);
    share_ += item.share;
    ++finished_;
    if (!options_.progress) return;
    double fraction = finished_ == queue_.size() ? 1.0 : std::min(share_, 1.0);
    if (options_.time_limit)
      fraction = std::max(fraction, std::min(0.999, elapsed() / *options_.time_limit));
    shown_ = std::max(shown_, fraction);
    options_.progress(shown_);
  }

  const PixelRenderer& pixels_;
  const RenderOptions& options_;
  FilmSums& sums_;
  PassQueue queue_;
  std::atomic<bool> cancelled_{false}, late_{false};
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::mutex mutex_;  // of what follows
  std::uint64_t finished_ = 0;
  double share_ = 0.0, shown_ = 0.0;
};

void count_samples(FilmSums& sums, RenderStatistics& statistics) {
  const SampleCounts counts = sums.counts();
  statistics.rays = counts.rays;
  statistics.samples = counts.samples;
  statistics.non_finite_samples = counts.non_finite;
  const FilmSums::Fireflies fireflies = sums.fireflies();
  statistics.firefly_pixels = fireflies.pixels;
  statistics.brightest_sample = fireflies.brightest;
}

}  // namespace

double RenderStatistics::seconds_of(const std::string& phase) const {
  for (const auto& [name, value] : seconds)
    if (name == phase) return value;
  return 0.0;
}

RenderRun render_into(FilmSums& sums, const Scene& scene, const RenderOptions& options) {
  const RenderSettings& settings = scene.settings;
  if (settings.spp < 1)
    throw std::invalid_argument(fmt::format("render: {} samples per pixel", settings.spp));
  if (settings.max_depth < 0)
    throw std::invalid_argument(fmt::format("render: max_depth is {}", settings.max_depth));
  if (options.threads < 0)
    throw std::invalid_argument(fmt::format("render: {} threads", options.threads));
  if (FilmLayout(settings, scene.light_groups.size()) != sums.layout())
    throw std::invalid_argument("render: the film is not one of this scene");

  RenderRun run;
  const Camera camera(scene.camera, settings.width, settings.height);
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    RenderStatistics& statistics = run.statistics;
    Stopwatch watch;
    const SceneAccel accel(scene);
    statistics.accel = accel.statistics();
    statistics.seconds.emplace_back("build", watch.restart());
    const MaterialSet materials(scene);
    statistics.seconds.emplace_back("materials", watch.restart());
    const LightSet lights(scene, options.direct_lighting == DirectLighting::kLightsOnly);
    statistics.seconds.emplace_back("lights", watch.restart());
    const SampleCounts before = sums.counts();
    statistics.earlier_samples = before.samples;
    statistics.earlier_rays = before.rays.total();

    const PathTracer tracer(scene, accel, materials, lights, camera, options.direct_lighting);
    const MatteNames names(scene);
    NonFiniteReport non_finite(options.stop_at_non_finite);
    const PixelRenderer pixels(tracer, camera, settings, settings.cryptomatte ? &names : nullptr,
                               sums.shard(), non_finite);
    TileRenderer tiles(pixels, options, sums);
    const int workers = tbb::this_task_arena::max_concurrency();
    tbb::parallel_for(
        tbb::blocked_range<int>(0, workers, 1),
        [&](const tbb::blocked_range<int>&) { tiles.work(); }, tbb::simple_partitioner());
    statistics.seconds.emplace_back("trace", watch.restart());
    run.end = tiles.end();
    count_samples(sums, statistics);
    statistics.non_finite_places = non_finite.places();
    statistics.textures = materials.texture_statistics();
    statistics.texture_numbers = materials.texture_numbers();
  });
  return run;
}

RenderResult render(const Scene& scene, const RenderOptions& options) {
  FilmSums sums(FilmLayout(scene.settings, scene.light_groups.size()));
  RenderRun run = render_into(sums, scene, options);
  return {sums.develop(), std::move(run.statistics), run.end};
}

}  // namespace morsel::render

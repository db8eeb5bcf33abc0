// SPDX-License-Identifier: Apache-2.0
#include "tools/render_job.h"

#include <fmt/format.h>
#include <oneapi/tbb/info.h>

#include <chrono>
#include <ctime>

#include "renderer/image/denoise.h"
#include "renderer/image/exr.h"
#include "renderer/image/png.h"
#include "renderer/scene/load_scene.h"
#include "renderer/scene/scene_identity.h"
#include "tools/checkpoint_writer.h"
#include "tools/image_check.h"
#include "tools/interrupt.h"
#include "tools/loading_progress.h"
#include "tools/preview.h"
#include "tools/render_statistics.h"
#include "tools/scene_options.h"
#include "tools/watcher.h"

namespace morsel::tools {
namespace {

using Clock = Watcher::Clock;

constexpr double kSignalInterval = 0.2;

// One scene's render in all its parts.
class Job {
 public:
  Job(const RenderPlan& plan, Reporter& reporter, const std::atomic<bool>& cancel)
      : plan_(plan), reporter_(reporter), cancel_(cancel) {}

  RenderedScene run(bool with_statistics) {
    auto start = Clock::now();
    loaded_ = load_for_render(plan_, reporter_, cancel_);
    report_.load_seconds = seconds_since(start);
    if (denoises() && render::denoiser_version().empty())
      reporter_.warn("this build has no Open Image Denoise: no denoised layer will be written");
    render::FilmSums sums(render::FilmLayout(scene().settings, scene().light_groups.size()),
                          plan_.shard);
    const nlohmann::json identity = identity_of();
    CheckpointWriter checkpoints(plan_, identity, sums, reporter_);
    const double earlier = checkpoints.resume();

    start = Clock::now();
    Preview preview(plan_, scene(), sums, reporter_);
    const std::clock_t processor = std::clock();
    render::RenderRun run = trace(sums, checkpoints, preview);
    run.statistics.earlier_seconds = earlier;
    report_.render_seconds = seconds_since(start);
    report_.processor_seconds = static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
    report_.threads = plan_.threads > 0 ? plan_.threads : oneapi::tbb::info::default_concurrency();
    warn_of(run);
    if (run.statistics.samples == 0 && run.end == render::RenderEnd::kCancelled)
      throw topology::Cancelled();

    start = Clock::now();
    RenderedScene result;
    result.interrupted = run.end == render::RenderEnd::kCancelled;
    render::RenderResult picture{sums.develop(), run.statistics, run.end};
    denoise(picture);
    preview.finish(picture.film);
    // The checkpoint first: pictures can be made of it. But if it fails, they are all there is.
    std::string failure;
    try {
      checkpoints.finish();
    } catch (const render::CheckpointError& e) {
      failure = e.what();
      reporter_.error(failure);
    }
    write_pictures(picture, sums, identity, result.files);
    if (!failure.empty()) throw std::runtime_error("the checkpoint was not written");
    report_.write_seconds = seconds_since(start);
    if (with_statistics) result.statistics = statistics_json(report_, plan_, loaded_, picture);
    return result;
  }

 private:
  const render::Scene& scene() const { return loaded_.scene; }

  // Read only when somebody compares it: it needs the bytes of every image.
  nlohmann::json identity_of() const {
    if (plan_.checkpoint.empty() && plan_.shard.count == 1) return nullptr;
    const bool by_count = plan_.shard.count > 1 || scene().settings.noise_target > 0.0f;
    return render::scene_identity(plan_.scene, plan_.overrides, loaded_, by_count);
  }

  render::RenderRun trace(render::FilmSums& sums, CheckpointWriter& checkpoints, Preview& preview) {
    render::RenderOptions options;
    options.threads = plan_.threads;
    options.cancel = &cancel_;
    options.progress = [&](double fraction) { reporter_.progress(fraction, "rendering"); };
    options.time_limit = plan_.time_limit;
    options.stop_at_non_finite = plan_.stop_at_nan;
    Watcher watcher;
    checkpoints.watch(watcher);
    preview.watch(watcher);
    watcher.add(Clock::now(), [&](Clock::time_point now) {
      if (take_picture_request()) write_partial(sums);
      return now + to_duration(kSignalInterval);
    });
    watcher.start();
    render::RenderRun run = render::render_into(sums, scene(), options);
    watcher.stop();
    return run;
  }

  // On SIGUSR1: the pictures as they are now, under their final names.
  void write_partial(render::FilmSums& sums) {
    try {
      render::RenderStatistics statistics;
      statistics.samples = sums.counts().samples;
      const render::RenderResult picture{sums.develop(), statistics, render::RenderEnd::kCancelled};
      std::vector<std::filesystem::path> files;
      write_pictures(picture, sums, identity_of(), files);
      for (const auto& file : files)
        reporter_.info(fmt::format("{}: written as it is now", file.string()));
    } catch (const std::exception& e) {
      reporter_.warn(e.what());
    }
  }

  void write_pictures(const render::RenderResult& picture, render::FilmSums& sums,
                      const nlohmann::json& identity, std::vector<std::filesystem::path>& files) {
    if (plan_.shard.count > 1)
      render::write_shard(plan_.exr, scene(), picture, sums, render::hash_of(identity));
    else
      render::write_exr(plan_.exr, scene(), picture);
    files.push_back(plan_.exr);
    const float exposure = scene().settings.exposure;
    if (!plan_.png.empty()) {
      render::write_png(plan_.png, picture.film, exposure, picture.denoised);
      files.push_back(plan_.png);
    }
  }

  // A shard is not the picture: merging denoises that.
  bool denoises() const { return scene().settings.denoise && plan_.shard.count == 1; }
  void denoise(render::RenderResult& picture) {
    if (denoises() && !render::denoiser_version().empty())
      picture.denoised = render::denoise(picture.film);
  }

  void warn_of(const render::RenderRun& run) {
    if (run.statistics.non_finite_samples > 0)
      reporter_.warn(fmt::format("{} of {} samples were not finite and count as black",
                                 run.statistics.non_finite_samples, run.statistics.samples));
    for (const render::NonFinitePlace& place : run.statistics.non_finite_places)
      reporter_.warn(fmt::format("not finite: {}", place.text()));
    if (const std::uint64_t limits = step_limits(scene()); limits > 0)
      reporter_.warn(fmt::format(
          "{} ray tests ended at the limit of field evaluations: hits may be missing", limits));
    if (run.end == render::RenderEnd::kDeadline) {
      const render::Crop window = render::window_of(scene().settings);
      const double pixels = double(window.x1 - window.x0) * (window.y1 - window.y0);
      reporter_.info(fmt::format("time is up after {:.3g} of {} samples a pixel",
                                 static_cast<double>(run.statistics.samples) / pixels,
                                 scene().settings.spp));
    }
  }

  const RenderPlan& plan_;
  Reporter& reporter_;
  const std::atomic<bool>& cancel_;
  render::LoadedScene loaded_;
  RenderReport report_;
};

}  // namespace

render::LoadedScene load_for_render(const RenderPlan& plan, Reporter& reporter,
                                    const std::atomic<bool>& cancel) {
  render::LoadOptions options;
  options.execution.cancel = &cancel;
  options.execution.max_bytes = bytes_of(default_max_memory());  // of labels that are missing
  options.execution.progress = loading_progress(reporter);
  options.warn = [&](const std::string& message) { reporter.warn(message); };
  options.check_image = check_image;
  options.max_brick_file = plan.max_brick_file;
  render::LoadedScene loaded = render::load_scene(plan.scene, plan.overrides, options);
  loaded.scene.settings.crop = plan.crop;
  for (const render::HypertextureReport& h : loaded.hypertextures) {
    reporter.debug(fmt::format("{}: cache {} {}", h.geometry, h.built ? "built" : "read from",
                               h.cache_file.string()));
    reporter.debug(fmt::format("{}: {} bricks {}", h.geometry, h.bricks,
                               h.bricks_were_read ? "read" : "made"));
  }
  if (cancel.load()) throw topology::Cancelled();
  return loaded;
}

RenderedScene render_scene(const RenderPlan& plan, bool with_statistics, Reporter& reporter,
                           const std::atomic<bool>& cancel) {
  return Job(plan, reporter, cancel).run(with_statistics);
}

}  // namespace morsel::tools

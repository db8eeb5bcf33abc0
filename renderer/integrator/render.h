// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "renderer/accel/scene_accel.h"
#include "renderer/film/film_sums.h"
#include "renderer/integrator/non_finite.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// How direct light is estimated. All three have the same mean; the single ones are for tests and
// for looking at what each contributes.
enum class DirectLighting { kMis, kLightsOnly, kBsdfOnly };

// How to render; what to render is in Scene. Nothing here changes a pixel but `direct_lighting`,
// and how far a render that is stopped got.
struct RenderOptions {
  int threads = 0;                            // 0: all that the process may use
  const std::atomic<bool>* cancel = nullptr;  // set to stop: pixels in work finish their pass
  // Seconds after which sampling stops, but not before every pixel has had its first pass.
  std::optional<double> time_limit;
  // Called with the finished fraction, growing to 1, from rendering threads but never at once.
  std::function<void(double fraction)> progress;
  DirectLighting direct_lighting = DirectLighting::kMis;
  // For finding where NaN comes from: the first sample that is not finite throws
  // std::runtime_error with its pixel and bounce.
  bool stop_at_non_finite = false;
};

struct RenderStatistics {
  RayCounts rays;
  std::uint64_t samples = 0;             // paths
  std::uint64_t non_finite_samples = 0;  // whose radiance was NaN or infinite and was taken as 0
  // The first of those of this run, in the order of the picture.
  std::vector<NonFinitePlace> non_finite_places;
  // What earlier runs brought, which is in the counts above too.
  std::uint64_t earlier_samples = 0, earlier_rays = 0;
  double earlier_seconds = 0.0;  // of tracing
  // See FilmSums::fireflies.
  std::uint64_t firefly_pixels = 0;
  float brightest_sample = 0.0f;
  SceneAccel::Statistics accel;
  std::string textures;  // of the texture system, for people; empty without images
  std::vector<std::pair<std::string, std::int64_t>> texture_numbers;
  std::vector<std::pair<std::string, double>>
      seconds;  // by phase, wall clock: build, lights, trace

  double seconds_of(const std::string& phase) const;  // 0 for an unknown phase
};

// Why rendering ended.
enum class RenderEnd { kDone, kCancelled, kDeadline };

struct RenderRun {
  RenderStatistics statistics;
  RenderEnd end = RenderEnd::kDone;
};

struct RenderResult {
  Film film;  // pixels that were not reached have samples == 0
  RenderStatistics statistics;
  RenderEnd end = RenderEnd::kDone;
  // By denoise(), row by row of the film's window, if that was asked for and could be done.
  std::vector<V3f> denoised = {};
  bool cancelled() const { return end == RenderEnd::kCancelled; }
};

// Renders the scene's crop (or everything) into `sums`, which has the layout of the scene's film,
// beyond what is in it already; it may be looked at meanwhile. The same scene gives the same pixels
// whatever the number of threads, the crop and the interruptions. Throws std::invalid_argument and
// std::runtime_error for scenes that cannot be rendered.
RenderRun render_into(FilmSums& sums, const Scene& scene, const RenderOptions& options = {});

// All of it at once.
RenderResult render(const Scene& scene, const RenderOptions& options = {});

}  // namespace morsel::render

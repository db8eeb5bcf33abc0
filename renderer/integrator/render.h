// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "renderer/accel/scene_accel.h"
#include "renderer/film/film.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// How direct light is estimated. All three have the same mean; the single ones are for tests and
// for looking at what each contributes.
enum class DirectLighting { kMis, kLightsOnly, kBsdfOnly };

// How to render; what to render is in Scene. Nothing here changes a pixel but `direct_lighting`.
struct RenderOptions {
  int threads = 0;                            // 0: all that the process may use
  const std::atomic<bool>* cancel = nullptr;  // set to stop: pixels in work are finished
  // Called with the finished fraction, growing to 1, from rendering threads but never at once.
  std::function<void(double fraction)> progress;
  DirectLighting direct_lighting = DirectLighting::kMis;
};

struct RayCounts {
  std::uint64_t camera = 0, bounce = 0, shadow = 0;
  std::uint64_t total() const { return camera + bounce + shadow; }
};

struct RenderStatistics {
  RayCounts rays;
  std::uint64_t samples = 0;             // paths
  std::uint64_t non_finite_samples = 0;  // whose radiance was NaN or infinite and was taken as 0
  // Pixels (or halves of adaptive ones) of 16 samples or more of which one sample is more than
  // half, and the luminance of the brightest sample of all.
  std::uint64_t firefly_pixels = 0;
  float brightest_sample = 0.0f;
  SceneAccel::Statistics accel;
  std::string textures;  // of the texture system, for people; empty without images
  std::vector<std::pair<std::string, double>>
      seconds;  // by phase, wall clock: build, lights, trace

  double seconds_of(const std::string& phase) const;  // 0 for an unknown phase
};

struct RenderResult {
  Film film;  // pixels that were not reached have samples == 0
  RenderStatistics statistics;
  // By denoise(), row by row of the film's window, if that was asked for and could be done.
  std::vector<V3f> denoised = {};
  bool cancelled = false;  // before all pixels were done
};

// Renders the scene's crop (or everything). The same scene gives the same pixels whatever the
// number of threads and the crop. Throws std::invalid_argument and std::runtime_error for scenes
// that cannot be rendered.
RenderResult render(const Scene& scene, const RenderOptions& options = {});

}  // namespace morsel::render

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "renderer/film/film_sums.h"
#include "renderer/scene/overrides.h"
#include "tools/reporter.h"
#include "tools/tev_client.h"

namespace morsel::tools {

// The flags of `morsel render` as they were given.
struct RenderFlags {
  std::vector<std::string> scenes, set;
  ReportingOptions reporting;
  std::string output, png;
  bool no_png = false;
  std::optional<std::int64_t> spp, seed;
  int threads = 0;
  double max_brick_file = 1.0;  // GiB
  std::string resolution, crop, keep, solver, membership, cache, stats;
  std::string time_limit, checkpoint, checkpoint_interval = "2%", shard, preview, debug_pixel;
  bool resume = false, denoise = false, check = false, stop_at_nan = false;
};
void add_render_flags(CLI::App& command, RenderFlags& flags);

// --set first, then the flags that stand for values of the scene. Throws UsageError and
// params::InputError.
std::vector<render::Override> render_overrides(const RenderFlags& flags, const std::string& scene);

// "text", "json" or "json:FILE".
struct StatisticsTarget {
  bool text = false, json = false;
  std::filesystem::path file;
  bool wanted() const { return text || json || !file.empty(); }
};

// When checkpoints are written: every so many seconds, or so that writing takes this share of the
// time.
struct CheckpointInterval {
  double seconds = 0.0, share = 0.0;  // one of them is 0
};

// What one scene's render is to be. Everything that the flags can be wrong in has been checked.
struct RenderPlan {
  std::string scene;
  std::vector<render::Override> overrides;
  std::optional<render::Crop> crop;
  render::Shard shard;
  std::filesystem::path exr, png, checkpoint, preview;  // empty: not wanted
  std::optional<TevAddress> tev;                        // viewer to show it in
  CheckpointInterval interval;
  bool resume = false;
  std::optional<double> time_limit;  // seconds
  int threads = 0;
  std::uint64_t max_brick_file = 0;  // bytes
  bool stop_at_nan = false;
};

// One plan a scene. Throws UsageError and params::InputError, and std::runtime_error when a file
// cannot be written.
std::vector<RenderPlan> plan_renders(const RenderFlags& flags);
StatisticsTarget parse_statistics(const std::string& text);

}  // namespace morsel::tools

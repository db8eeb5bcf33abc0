// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "renderer/film/checkpoint.h"
#include "tools/render_options.h"
#include "tools/reporter.h"
#include "tools/watcher.h"

namespace morsel::tools {

// Writes the checkpoints of one render, or none when its plan names no file.
class CheckpointWriter {
 public:
  CheckpointWriter(const RenderPlan& plan, nlohmann::json identity, render::FilmSums& sums,
                   Reporter& reporter);

  // Fills the sums from the file, if the plan says so. Returns the seconds of earlier runs. Throws
  // render::CheckpointError.
  double resume();
  // Rendering begins: from now on a checkpoint is written from time to time.
  void watch(Watcher& watcher);
  // The last one. Throws render::CheckpointError.
  void finish();

 private:
  void write();
  Watcher::Clock::time_point write_in_between(Watcher::Clock::time_point now);

  const RenderPlan& plan_;
  nlohmann::json identity_;
  render::FilmSums& sums_;
  Reporter& reporter_;
  double earlier_seconds_ = 0.0;
  Watcher::Clock::time_point start_ = Watcher::Clock::now();
};

}  // namespace morsel::tools

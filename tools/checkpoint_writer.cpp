// SPDX-License-Identifier: Apache-2.0
#include "tools/checkpoint_writer.h"

#include <fmt/format.h>

#include <algorithm>

namespace morsel::tools {
namespace {

using Clock = Watcher::Clock;

// Between two checkpoints whose interval is a share of the time: small pictures take no time at all
// to write, and disks tire.
constexpr double kShortest = 10.0;

}  // namespace

CheckpointWriter::CheckpointWriter(const RenderPlan& plan, nlohmann::json identity,
                                   render::FilmSums& sums, Reporter& reporter)
    : plan_(plan), identity_(std::move(identity)), sums_(sums), reporter_(reporter) {}

double CheckpointWriter::resume() {
  if (plan_.checkpoint.empty() || !plan_.resume) return 0.0;
  if (!std::filesystem::exists(plan_.checkpoint)) {
    reporter_.warn(fmt::format("{}: no such checkpoint; rendering begins with the first sample",
                               plan_.checkpoint.string()));
    return 0.0;
  }
  earlier_seconds_ = render::read_checkpoint(plan_.checkpoint, identity_, sums_).seconds;
  reporter_.info(fmt::format("{}: goes on after {} samples", plan_.checkpoint.string(),
                             sums_.counts().samples));
  return earlier_seconds_;
}

void CheckpointWriter::write() {
  render::write_checkpoint(plan_.checkpoint, sums_,
                           {identity_, earlier_seconds_ + seconds_since(start_)});
}

Clock::time_point CheckpointWriter::write_in_between(Clock::time_point now) {
  const auto begin = Clock::now();
  try {
    write();
    reporter_.debug(
        fmt::format("{}: written in {:.2f} s", plan_.checkpoint.string(), seconds_since(begin)));
  } catch (const std::exception& e) {
    // Rendering is worth more than the checkpoint; the next one may succeed.
    reporter_.warn(e.what());
  }
  if (plan_.interval.seconds > 0.0) return now + to_duration(plan_.interval.seconds);
  return Clock::now() + to_duration(std::max(
                            kShortest, seconds_since(begin) * (1.0 / plan_.interval.share - 1.0)));
}

void CheckpointWriter::watch(Watcher& watcher) {
  start_ = Clock::now();
  if (plan_.checkpoint.empty()) return;
  const double first = plan_.interval.seconds > 0.0 ? plan_.interval.seconds : kShortest;
  watcher.add(start_ + to_duration(first),
              [this](Clock::time_point now) { return write_in_between(now); });
}

void CheckpointWriter::finish() {
  if (!plan_.checkpoint.empty()) write();
}

}  // namespace morsel::tools

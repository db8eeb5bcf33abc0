// SPDX-License-Identifier: Apache-2.0
#include "tools/reporter.h"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace morsel::tools {
namespace {

constexpr double kBarInterval = 0.1;  // seconds between two drawings
constexpr double kPlainInterval = 3.0;
constexpr int kBarWidth = 30;

std::string duration(double seconds) {
  if (seconds < 60) return fmt::format("{:.0f} s", seconds);
  const int whole = static_cast<int>(seconds);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

std::string remaining(double fraction, double seconds) {
  if (fraction < 0.02 || seconds < 1 || fraction >= 1) return "";
  return ", " + duration(seconds * (1 - fraction) / fraction) + " left";
}

}  // namespace

void add_reporting_options(CLI::App& command, ReportingOptions& options) {
  command.add_option("--progress", options.progress, "How to show progress on stderr")
      ->check(CLI::IsMember({"auto", "bar", "plain", "json", "none"}))
      ->capture_default_str();
  command.add_option("--log-level", options.log_level, "Least severe messages to show")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}))
      ->capture_default_str();
  auto* quiet = command.add_flag("-q,--quiet", options.quiet, "Only errors, no progress");
  command.add_flag("-v,--verbose", options.verbose, "The same as --log-level debug")
      ->excludes(quiet);
}

Reporter::Reporter(const ReportingOptions& options) {
  if (options.progress == "bar")
    style_ = Style::kBar;
  else if (options.progress == "plain")
    style_ = Style::kPlain;
  else if (options.progress == "json")
    style_ = Style::kJson;
  else if (options.progress == "auto" && !options.quiet)
    style_ = isatty(STDERR_FILENO) ? Style::kBar : Style::kPlain;

  auto logger =
      std::make_shared<spdlog::logger>("morsel", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_pattern("morsel: %l: %v");
  logger->set_level(options.quiet     ? spdlog::level::err
                    : options.verbose ? spdlog::level::debug
                                      : spdlog::level::from_str(options.log_level));
  spdlog::set_default_logger(logger);
}

Reporter::~Reporter() {
  const std::lock_guard lock(mutex_);
  clear_bar();
}

void say(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

void Reporter::progress(double fraction, const std::string& phase) {
  if (style_ == Style::kNone) return;
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  fraction = std::clamp(fraction, 0.0, 1.0);
  const bool new_phase = phase != phase_ || (phase_ended_ && fraction < 1);
  if (new_phase) {
    phase_ = phase;
    phase_start_ = now;
    phase_ended_ = false;
  }
  const double interval = style_ == Style::kBar ? kBarInterval : kPlainInterval;
  const double since_drawn = std::chrono::duration<double>(now - last_drawn_).count();
  const bool ends = fraction >= 1 && !phase_ended_;
  if (!new_phase && !ends && (phase_ended_ || since_drawn < interval)) return;
  phase_ended_ = fraction >= 1;
  last_drawn_ = now;
  draw(fraction, phase, std::chrono::duration<double>(now - phase_start_).count());
}

void Reporter::draw(double fraction, const std::string& phase, double seconds) {
  const int percent = static_cast<int>(fraction * 100);
  if (style_ == Style::kBar) {
    const int filled = static_cast<int>(fraction * kBarWidth);
    say(fmt::format("\r\033[K{} [{:#<{}}{:{}}] {:3} %  {}{}", phase, "", filled, "",
                    kBarWidth - filled, percent, duration(seconds), remaining(fraction, seconds)));
    bar_shown_ = true;
    if (fraction >= 1) {
      say("\n");
      bar_shown_ = false;
    }
  } else if (style_ == Style::kPlain) {
    say(fmt::format("{}: {} % ({}{})\n", phase, percent, duration(seconds),
                    remaining(fraction, seconds)));
  } else {
    const nlohmann::json line = {{"phase", phase}, {"fraction", fraction}, {"seconds", seconds}};
    say(line.dump() + "\n");
  }
}

void Reporter::clear_bar() {
  if (!bar_shown_) return;
  say("\r\033[K");
  bar_shown_ = false;
}

void Reporter::debug(const std::string& message) {
  const std::lock_guard lock(mutex_);
  clear_bar();
  spdlog::debug("{}", message);
}

void Reporter::info(const std::string& message) {
  const std::lock_guard lock(mutex_);
  clear_bar();
  spdlog::info("{}", message);
}

void Reporter::warn(const std::string& message) {
  const std::lock_guard lock(mutex_);
  clear_bar();
  spdlog::warn("{}", message);
}

void Reporter::error(const std::string& message) {
  const std::lock_guard lock(mutex_);
  clear_bar();
  spdlog::error("{}", message);
}

}  // namespace morsel::tools

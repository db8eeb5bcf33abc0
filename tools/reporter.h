// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <mutex>
#include <string>

namespace morsel::tools {

// Options that every longer command has.
struct ReportingOptions {
  std::string progress = "auto";   // auto, bar, plain, json, none
  std::string log_level = "info";  // trace, debug, info, warn, error, off
  bool quiet = false;              // neither progress nor anything below errors
  bool verbose = false;            // log level debug
};
void add_reporting_options(CLI::App& command, ReportingOptions& options);

// Writes to stderr, or does nothing where that fails: a log on a disk that is full must not end
// hours of work.
void say(const std::string& text);

// Progress and log messages, both on stderr. Methods may be called from any thread.
class Reporter {
 public:
  explicit Reporter(const ReportingOptions& options);
  ~Reporter();  // ends the line of a bar
  Reporter(const Reporter&) = delete;
  Reporter& operator=(const Reporter&) = delete;

  // `fraction` in [0, 1] of the phase. A bar is redrawn up to ten times a second; plain lines come
  // at the start of a phase, every few seconds and at its end; JSON is one object a line.
  void progress(double fraction, const std::string& phase);

  void debug(const std::string& message);
  void info(const std::string& message);
  void warn(const std::string& message);
  void error(const std::string& message);

 private:
  enum class Style { kBar, kPlain, kJson, kNone };
  using Clock = std::chrono::steady_clock;
  void clear_bar();
  void draw(double fraction, const std::string& phase, double seconds);

  std::mutex mutex_;
  Style style_ = Style::kNone;
  bool bar_shown_ = false;
  bool phase_ended_ = false;
  std::string phase_;
  Clock::time_point phase_start_, last_drawn_;
};

}  // namespace morsel::tools

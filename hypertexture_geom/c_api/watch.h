// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <string_view>
#include <vector>

#include "hypertexture_geom/include/morsel/hypertexture_geom.h"
#include "topology/certified.h"

// What the caller sees of a long operation: its progress as one fraction that never falls, and the
// question whether to stop.
namespace morsel::c_api {

// A phase as the work names it, and its share of the whole. An estimate: it moves no result.
struct Phase {
  std::string_view name;
  double share;
};

class Watch {
 public:
  // The callbacks may be null. Phases in their order; shares add up to 1. Throws Cancelled if the
  // caller says so at once.
  Watch(void (*progress)(void*, double, const char*), std::int32_t (*cancel)(void*), void* user,
        std::vector<Phase> phases);

  // `options`: MorselBuildOptions or MorselGeometryOptions.
  template <class Options>
  Watch(const Options& options, std::vector<Phase> phases)
      : Watch(options.progress, options.cancel, options.user, std::move(phases)) {}

  // Points to this object.
  topology::Execution execution();
  // All is done: the last report has the fraction 1. Throws Cancelled if the caller said so at the
  // one before, too late for the work to stop.
  void finish();

 private:
  void report(double fraction, const char* phase);

  void (*progress_)(void*, double, const char*);
  std::int32_t (*cancel_)(void*);
  void* user_;
  std::vector<Phase> phases_;
  double last_ = 0.0;
  std::atomic<bool> cancelled_{false};
};

}  // namespace morsel::c_api

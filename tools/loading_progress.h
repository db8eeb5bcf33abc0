// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <functional>
#include <string>

#include "tools/reporter.h"

namespace morsel::tools {

// Shows the phases of render::load_scene(), with a word for what they belong to. `reporter` must
// outlive it.
inline std::function<void(double, const char*)> loading_progress(Reporter& reporter) {
  return [&reporter](double fraction, const std::string& phase) {
    const bool of_rays = phase == "bricks" || phase == "slopes";
    reporter.progress(fraction, fmt::format("{}: {}", of_rays ? "surface" : "topology", phase));
  };
}

}  // namespace morsel::tools

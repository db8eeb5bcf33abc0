// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "renderer/scene/overrides.h"
#include "tools/reporter.h"

namespace morsel::tools {

// `render --debug-pixel x,y`: prints on stdout what each sample of a pixel sees and which rays it
// takes. Returns the exit code.
int debug_pixel(const std::string& scene, const std::vector<render::Override>& overrides,
                const std::string& pixel, Reporter& reporter, const std::atomic<bool>& cancel);

}  // namespace morsel::tools

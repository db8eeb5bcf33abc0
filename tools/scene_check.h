// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "renderer/scene/overrides.h"
#include "tools/reporter.h"

namespace morsel::tools {

// Prints the problems of a scene on stdout, or that there are none; returns the exit code.
int print_problems(const std::string& scene, const std::vector<render::Override>& overrides,
                   Reporter& reporter, bool json);

}  // namespace morsel::tools

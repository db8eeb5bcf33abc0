// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace morsel::tools {

// The results of `morsel bench` (its JSON document) as one page of HTML: tables and plots (SVG
// within the page), nothing from the network.
std::string bench_page(const nlohmann::json& result);

}  // namespace morsel::tools

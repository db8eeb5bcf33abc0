// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace morsel::tools {

struct BenchPicture {
  std::string caption;
  std::string png;  // the file's bytes
};

// The results of `morsel bench` (its JSON document) as one page of HTML: tables, plots (SVG
// within the page) and pictures (data URLs), nothing from the network.
std::string bench_page(const nlohmann::json& result,
                       const std::vector<BenchPicture>& pictures = {});

}  // namespace morsel::tools

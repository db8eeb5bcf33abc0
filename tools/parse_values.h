// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "renderer/film/film_sums.h"

// Values of flags that are more than a number. All throw UsageError that names the flag and says
// what its value must be.
namespace morsel::tools {

// Exactly `count` integers separated by `separator`.
std::vector<int> parse_integers(const std::string& flag, const std::string& text, char separator,
                                std::size_t count, const char* form);

// Seconds: "90", "90s", "15m", "1.5h". Positive.
double parse_duration(const std::string& flag, const std::string& text);

// "2%" as 0.02, in (0, 100].
double parse_percentage(const std::string& flag, const std::string& text);

// "INDEX/COUNT", the index counted from 0.
render::Shard parse_shard(const std::string& flag, const std::string& text);

}  // namespace morsel::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace morsel::params {

// What other renderers' scene files call a thing, in lower case without separators, and what it is
// called here.
const std::vector<std::pair<std::string_view, std::string_view>>& synonyms();

// The one of `known` that whoever wrote `name` is likely to have meant: what another renderer calls
// so, else the nearest by spelling; empty when there is neither.
std::string suggested_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace morsel::params

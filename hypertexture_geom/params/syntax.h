// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace morsel::params {

// The first thing in `text` that keeps it from being a JSON document (comments are allowed):
// syntax, a key twice in one object, a number that no double holds, arrays and objects too deep in
// one another. "line 3, column 5: found '}', expected a value": columns are characters, from 1.
// Empty when json::parse will accept the text.
std::string syntax_problem(const std::string& text);

}  // namespace morsel::params

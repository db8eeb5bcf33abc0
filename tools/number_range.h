// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace morsel::tools {

// Checks of flags whose values are numbers. Unlike CLI11's own, they refuse NaN.
CLI::Validator number_from(double least, double greatest);
CLI::Validator number_above_zero();
CLI::Validator number_from_zero();

}  // namespace morsel::tools

// SPDX-License-Identifier: Apache-2.0
#include "tools/number_range.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <string>

namespace morsel::tools {
namespace {

// CLI11 shows `description` in the help, and the name of the flag before the error.
CLI::Validator where(const std::function<bool(double)>& holds, const std::string& description) {
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        double value = 0.0;
        // An empty text is converted to 0.
        if (!text.empty() && CLI::detail::lexical_cast(text, value) && holds(value)) return "";
        return fmt::format("Value {} not in range", text);
      },
      description);
}

}  // namespace

CLI::Validator number_from(double least, double greatest) {
  return where([=](double x) { return x >= least && x <= greatest; },
               fmt::format("FLOAT in [{:g} - {:g}]", least, greatest));
}

CLI::Validator number_above_zero() {
  return where([](double x) { return x > 0.0 && std::isfinite(x); }, "POSITIVE");
}

CLI::Validator number_from_zero() {
  return where([](double x) { return x >= 0.0 && std::isfinite(x); }, "NONNEGATIVE");
}

}  // namespace morsel::tools

// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/value_span.h"

#include <fmt/format.h>

namespace morsel::geom {

using params::Type;

std::vector<params::Parameter> value_span_parameters() {
  return {
      {"from", Type::kNumber, 0.0, "Value that stays.", "length", -1e6, 1e6},
      {"to", Type::kNumber, 1.0, "The other value that stays; above `from`.", "length", -1e6, 1e6}};
}

ValueSpan value_span_from_json(const params::JsonReader& r) {
  const double from = r.number("from"), to = r.number("to"), width = to - from;
  if (!(width > 1e-9)) r.place("to").fail(fmt::format("{} must be above \"from\", {}", to, from));
  return {width, from + 0.5 * width};
}

}  // namespace morsel::geom

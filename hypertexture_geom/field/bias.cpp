// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/bias.h"

#include <algorithm>
#include <cmath>

#include "hypertexture_geom/field/univariate_function.h"
#include "hypertexture_geom/field/value_span.h"

namespace morsel::geom {

using params::JsonReader;
using params::Type;

ModulationEntry bias_entry() {
  ModulationEntry entry{
      {"bias",
       "Bends values between `from` and `to` so that their middle comes to `bias` of the way; "
       "increasing everywhere.",
       {{"type", Type::kString, "bias", "Kind of modulation."},
        {"bias", Type::kNumber, 0.5, "Where the middle goes: 0.5 changes nothing.", "", 0.01,
         0.99}}},
      [](std::shared_ptr<const Expression> previous, const JsonReader& r) {
        const auto [width, middle] = value_span_from_json(r);
        // B(1/2) = 1/2 - c s(1/2) = b with s(1/2) = 1 / (4 e), e = sqrt(1/4 + k^2) + k >= 1/2, so
        // that c = 4 e (1/2 - b). Any e below 1 / |4 b - 2| keeps |c| < 1; the geometric mean of
        // both limits does, and 1 is wide enough.
        const double b = r.number("bias");
        const double e = std::min(1.0, 0.5 / std::sqrt(std::max(1e-12, std::abs(1.0 - 2.0 * b))));
        const double k = (e * e - 0.25) / (2.0 * e), c = 4.0 * e * (0.5 - b);
        return make_univariate(hyperbola_function({.bend_at = middle,
                                                   .width = k * width,
                                                   .constant = middle - c * width * 0.25 / e,
                                                   .slope = 1.0,
                                                   .absolute = c}),
                               std::move(previous));
      }};
  for (params::Parameter& p : value_span_parameters())
    entry.declaration.parameters.push_back(std::move(p));
  return entry;
}

}  // namespace morsel::geom

// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/gain.h"

#include <cmath>

#include "hypertexture_geom/field/univariate_function.h"
#include "hypertexture_geom/field/value_span.h"

namespace morsel::geom {

using params::JsonReader;
using params::Type;

ModulationEntry gain_entry() {
  ModulationEntry entry{
      {"gain",
       "Steepens (gain above 0.5) or flattens the middle between `from` and `to`; increasing "
       "everywhere.",
       {{"type", Type::kString, "gain", "Kind of modulation."},
        {"gain", Type::kNumber, 0.5,
         "The slope in the middle is log2(1 / (1 - gain)): 0.5 changes nothing.", "", 0.01, 0.99}}},
      [](std::shared_ptr<const Expression> previous, const JsonReader& r) {
        const auto [width, middle] = value_span_from_json(r);
        // G(0) = 0 and G(1) = 1: alpha + beta q = 1 with q = 1 / sqrt(1/4 + k^2); slope at 1/2:
        // alpha + beta / k. Far away it is alpha, positive for k < 1 / (2 sqrt(slope^2 - 1)).
        const double slope = -std::log2(1.0 - r.number("gain"));
        const double k = 0.5 / std::sqrt(slope * slope + 1.0);
        const double q = 1.0 / std::sqrt(0.25 + k * k);
        const double beta = (slope - 1.0) / (1.0 / k - q), alpha = 1.0 - beta * q;
        return make_univariate(hyperbola_function({.bend_at = middle,
                                                   .width = k * width,
                                                   .constant = middle,
                                                   .slope = alpha,
                                                   .sign = beta * width}),
                               std::move(previous));
      }};
  for (params::Parameter& p : value_span_parameters())
    entry.declaration.parameters.push_back(std::move(p));
  return entry;
}

}  // namespace morsel::geom
